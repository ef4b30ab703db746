//! The page with everything on it, for a browser: no other file, no script, no address outside.

use std::fmt::Write;

use super::claims::Claim;
use super::differences::DIFFERENCES;
use super::figure::Figure;
use super::plot;
use super::table::{Row, Table};
use super::text::{Column, KGM, columns, escaped, largest_errors, named, number, percent, same_quantities};

const STYLE: &str = include_str!("report.css");

/// Writes the page.
#[must_use]
pub fn page(tables: &[Table], parameter_set_hash: &str) -> String {
    let mut body = String::from(
        "<h1>The thesis, reproduced</h1>\n<p>The tables and figures of S. Santaera, <em>Development of prognostic algorithm for \
         electrohydraulic flight controls</em>, Politecnico di Torino, 2021, made again by elevon: ours beside the thesis's. The \
         text of the thesis was at hand, its drawings were not, so figures are compared with what the thesis says of \
         them.</p>\n",
    );
    body += &summary(tables);
    body += &contradicted(tables);
    body += &contents(tables);
    for table in tables {
        body += &section(table);
    }
    body += &differences();
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <title>The thesis, reproduced</title><style>{}{STYLE}</style></head>\n<body><main>\n{body}\
         <p class=\"soft\">elevon {}, parameter set {}.</p>\n</main></body></html>\n",
        plot::style(),
        crate::VERSION,
        escaped(parameter_set_hash)
    )
}

/// The answer first: the largest errors, and how many statements come out.
fn summary(tables: &[Table]) -> String {
    let mut rows = String::new();
    for table in tables {
        let is_estimate = |quantity| table.of(quantity).any(|c| c.thesis_error_percent.is_some());
        let mut lines: Vec<[String; 3]> = Vec::new();
        for (quantity, thesis, ours) in largest_errors(table) {
            let thesis = if is_estimate(quantity) { percent(thesis) } else { "is the measure".into() };
            lines.push([format!("{}, %", without_unit(quantity)), thesis, percent(ours)]);
        }
        for quantity in KGM {
            if let Some((thesis, ours)) = table.largest_kgm_off(quantity) {
                lines.push([format!("{}, itself", named(quantity)), number(thesis), number(Some(ours))]);
            }
        }
        for (at, [quantity, thesis, ours]) in lines.iter().enumerate() {
            let (name, title, height) = (table.name.name(), escaped(table.title), lines.len());
            let first = format!("<td rowspan=\"{height}\"><a href=\"#{name}\">{title}</a></td>");
            let first = if at == 0 { first } else { String::new() };
            let _ = writeln!(rows, "<tr>{first}<td>{quantity}</td><td>{thesis}</td><td>{ours}</td></tr>");
        }
    }
    let claims = || tables.iter().flat_map(|table| &table.claims);
    let (all, agree) = (claims().count(), claims().filter(|claim| claim.agrees).count());
    let mut text = String::new();
    if !rows.is_empty() {
        let _ = writeln!(
            text,
            "<div class=\"wide\"><table class=\"summary\"><caption>Largest errors: of an estimate against the true value, of a \
             feature (table 6.3) or a fitted constant against the thesis's</caption><thead><tr><th>table</th><th>quantity</th><th>thesis</th>\
             <th>ours</th></tr></thead><tbody>\n{rows}</tbody></table></div>"
        );
    }
    if all > 0 {
        let _ =
            writeln!(text, "<p>Of {all} statements of the thesis on these tables and figures, {agree} come out.</p>");
    }
    text
}

/// A quantity's name for an error in per cent.
fn without_unit(quantity: &str) -> String {
    let name = named(quantity);
    name.split(", ").filter(|part| !matches!(*part, "mA" | "kPa" | "N")).collect::<Vec<_>>().join(", ")
}

/// The statements that do not come out.
fn contradicted(tables: &[Table]) -> String {
    let differ: Vec<&Claim> = tables.iter().flat_map(|table| &table.claims).filter(|claim| !claim.agrees).collect();
    if differ.is_empty() { String::new() } else { claims("Those that do not come out", &differ) }
}

fn contents(tables: &[Table]) -> String {
    let mut items = String::new();
    for table in tables {
        let mut item = |id: &str, text: &str| {
            let _ = writeln!(items, "<li><a href=\"#{id}\">{}</a></li>", escaped(text));
        };
        item(table.name.name(), &format!("{}: {}", table.name.name(), table.title));
        headings(table).iter().for_each(|heading| item(&slug(heading), heading));
    }
    format!("<nav><ul>\n{items}<li><a href=\"#differences\">Where we differ, and why</a></li>\n</ul></nav>\n")
}

/// The headings of a table's rows and figures, each once, in the order of the thesis's sections.
fn headings(table: &Table) -> Vec<&str> {
    let of_figures = table.figures.iter().map(|figure| figure.heading.as_str());
    let all = of_figures.chain(table.rows.iter().map(|row| row.heading.as_str()));
    let mut headings: Vec<&str> = Vec::new();
    for heading in all.filter(|heading| !heading.is_empty()) {
        if !headings.contains(&heading) {
            headings.push(heading);
        }
    }
    headings.sort_by_key(|heading| section_of(heading));
    headings
}

/// The section that a heading such as `Section 6.1.1: ...` names.
fn section_of(heading: &str) -> &str {
    heading.trim_start_matches("Section ").split(':').next().unwrap_or_default()
}

fn slug(heading: &str) -> String {
    heading
        .chars()
        .filter(|c| !matches!(c, ',' | ':'))
        .map(|c| if c.is_alphanumeric() || c == '.' { c } else { '-' })
        .collect()
}

fn section(table: &Table) -> String {
    let mut text = format!("<h2 id=\"{0}\">{0}: {1}</h2>\n", table.name.name(), escaped(table.title));
    for note in &table.notes {
        let _ = writeln!(text, "<p class=\"soft\">{}</p>", escaped(note));
    }
    let headings = headings(table);
    if headings.is_empty() {
        text += &grid(&table.rows.iter().collect::<Vec<_>>());
        text += &claims("What the thesis says of it", &table.claims.iter().collect::<Vec<_>>());
        return text;
    }
    let mut told: Vec<&str> = Vec::new();
    for heading in headings {
        let _ = writeln!(text, "<h3 id=\"{}\">{}</h3>", slug(heading), escaped(heading));
        let section = section_of(heading);
        if !told.contains(&section) {
            told.push(section);
            let of: Vec<&Claim> = table.claims.iter().filter(|claim| claim.section == section).collect();
            text += &claims("What the thesis says of it", &of);
        }
        let figures: Vec<&Figure> = table.figures.iter().filter(|figure| figure.heading == heading).collect();
        let rows: Vec<&Row> = table.rows.iter().filter(|row| row.heading == heading).collect();
        text += &shown(&figures);
        if figures.is_empty() {
            text += &grid(&rows);
        } else if !rows.is_empty() {
            let _ = writeln!(text, "<details><summary>Its figures as numbers</summary>{}</details>", grid(&rows));
        }
    }
    text
}

fn grid(rows: &[&Row]) -> String {
    let mut text = String::new();
    for rows in rows.chunk_by(|a, b| same_quantities(a, b)) {
        let rows: Vec<Row> = rows.iter().map(|row| (*row).clone()).collect();
        let columns = columns(&rows);
        let heads = heads(&columns);
        let mut body = String::new();
        for row in 0..rows.len() {
            let cells: String =
                columns.iter().map(|column| format!("<td>{}</td>", escaped(&column.cells[row]))).collect();
            let _ = writeln!(body, "<tr>{cells}</tr>");
        }
        let _ =
            writeln!(text, "<div class=\"wide\"><table><thead>{heads}</thead><tbody>\n{body}</tbody></table></div>");
    }
    text
}

/// The headings of a grid: the quantities over what is told of each.
fn heads(columns: &[Column]) -> String {
    if columns.iter().all(|column| column.group.is_empty()) {
        return format!(
            "<tr>{}</tr>",
            columns.iter().map(|c| format!("<th>{}</th>", escaped(&c.name))).collect::<String>()
        );
    }
    let (mut above, mut below) = (String::new(), String::new());
    for group in columns.chunk_by(|a, b| !a.group.is_empty() && a.group == b.group) {
        let Column { group: name, name: own, .. } = &group[0];
        if name.is_empty() {
            let _ = write!(above, "<th rowspan=\"2\">{}</th>", escaped(own));
            continue;
        }
        let _ = write!(above, "<th class=\"group\" colspan=\"{}\">{}</th>", group.len(), escaped(name));
        below.extend(group.iter().map(|column| format!("<th>{}</th>", escaped(&column.name))));
    }
    format!("<tr>{above}</tr><tr>{below}</tr>")
}

fn claims(caption: &str, claims: &[&Claim]) -> String {
    let row = |claim: &&Claim| {
        let (class, word) = if claim.agrees { ("yes", "agrees") } else { ("no", "differs") };
        let why = claim.why.filter(|_| !claim.agrees).map_or_else(String::new, |why| format!(" {why}."));
        [
            format!("{} <span class=\"{class}\">{word}</span>", escaped(claim.section)),
            escaped(claim.thesis),
            escaped(&format!("{}{why}", claim.ours)),
        ]
    };
    let rows: Vec<[String; 3]> = claims.iter().map(row).collect();
    if rows.is_empty() { String::new() } else { words(caption, ["section", "the thesis", "ours"], &rows) }
}

/// A table of sentences; on a narrow screen its rows become paragraphs.
fn words<const N: usize>(caption: &str, heads: [&str; N], rows: &[[String; N]]) -> String {
    let mut body = String::new();
    for row in rows {
        let cell = |(at, cell): (usize, &String)| match at {
            0 => format!("<td>{cell}</td>"),
            _ => format!("<td data-head=\"{}\">{cell}</td>", heads[at]),
        };
        let _ = writeln!(body, "<tr>{}</tr>", row.iter().enumerate().map(cell).collect::<String>());
    }
    let heads = heads.map(|head| format!("<th>{head}</th>")).concat();
    format!(
        "<div class=\"wide\"><table class=\"words\"><caption>{caption}</caption><thead><tr>{heads}</tr></thead><tbody>\n\
         {body}</tbody></table></div>\n"
    )
}

/// Figures; those on demand behind one line each.
fn shown(figures: &[&Figure]) -> String {
    let mut text = String::new();
    for group in figures.chunk_by(|a, b| a.folded == b.folded) {
        let one = |figure: &&Figure| {
            format!("<figure>{}<figcaption>{}</figcaption></figure>\n", plot::inline(figure), escaped(&figure.caption))
        };
        let grid = format!("<div class=\"figures\">\n{}</div>\n", group.iter().map(one).collect::<String>());
        match group[0].folded {
            None => text += &grid,
            Some(what) => {
                let _ = writeln!(text, "<details><summary>{}</summary>{grid}</details>", escaped(what));
            }
        }
    }
    text
}

fn differences() -> String {
    let rows: Vec<[String; 4]> =
        DIFFERENCES.iter().map(|d| [d.place, d.thesis, d.here, d.reason].map(escaped)).collect();
    let table = words("Slips of the thesis, and what we do", ["section", "the thesis", "here", "why"], &rows);
    format!("<h2 id=\"differences\">Where we differ, and why</h2>\n{table}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduction::Name;
    use crate::reproduction::figure::tests::example;

    fn claim(section: &'static str, agrees: bool) -> Claim {
        Claim { section, thesis: "1 < 2", ours: "By 3.".into(), agrees, why: Some("Because of 4") }
    }

    fn tables() -> Vec<Table> {
        let mut tables: Vec<Table> =
            Name::ALL.iter().map(|&name| Table::new(name, "title", Vec::new(), vec!["A note <b>.".into()])).collect();
        let mut figure = example(&[0.0, 1.0]);
        figure.heading = "Section 6.1.1: a step, growing".into();
        tables[0].figures = vec![figure.clone(), Figure { folded: Some("More"), ..figure }];
        tables[0].claims = vec![claim("6.1.1", true), claim("6.1.1", false)];
        tables
    }

    #[test]
    fn the_page_names_every_table_and_reaches_nowhere_else() {
        let page = page(&tables(), "hash");
        for name in Name::ALL {
            assert!(page.contains(&format!("<h2 id=\"{}\">", name.name())), "{name:?}");
        }
        assert!(page.contains("class=\"line l0\"") && page.contains("1 &lt; 2") && !page.contains("<b>"));
        for reach in ["http:", "https:", "<script", "url(", "@import", "src=", "<link", "<img"] {
            assert!(!page.contains(reach), "{reach}");
        }
    }

    #[test]
    fn every_link_leads_to_a_heading_of_the_page() {
        let page = page(&tables(), "hash");
        let links: Vec<&str> = page.split("href=\"#").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
        assert!(links.len() > Name::ALL.len() && links.contains(&"Section-6.1.1-a-step-growing"));
        for link in links {
            assert!(page.contains(&format!("id=\"{link}\"")), "{link}");
        }
    }

    #[test]
    fn statements_are_counted_first_and_one_that_differs_stands_there_with_its_reason() {
        let page = page(&tables(), "hash");
        let first = page.split("<nav>").next().unwrap();
        assert!(
            first.contains("Of 2 statements") && first.contains("1 come out") && first.contains("By 3. Because of 4.")
        );
        assert_eq!(page.matches(">differs<").count(), 2, "above, and beside its figures");
        assert_eq!(page.matches("Because of 4").count(), 2, "a statement that agrees needs no reason");
    }
}
