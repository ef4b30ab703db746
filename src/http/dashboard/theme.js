// A classic script in the head: a remembered theme applies before the first paint.
(() => {
  const KEY = "elevon.theme";
  const NAMES = { auto: "Auto", light: "Light", dark: "Dark" };
  const root = document.documentElement;

  function remembered() {
    try {
      const stored = localStorage.getItem(KEY);
      return stored in NAMES ? stored : "auto";
    } catch {
      return "auto";
    }
  }

  function remember(theme) {
    try {
      localStorage.setItem(KEY, theme);
    } catch {
      // Without storage the choice lasts as long as the page.
    }
  }

  function apply(theme) {
    if (theme === "auto") delete root.dataset.theme;
    else root.dataset.theme = theme;
  }

  let theme = remembered();
  apply(theme);

  document.addEventListener("DOMContentLoaded", () => {
    const button = document.getElementById("theme");
    const show = () => {
      button.textContent = NAMES[theme];
      button.setAttribute("aria-label", `Theme: ${NAMES[theme]}. Change it`);
    };
    button.addEventListener("click", () => {
      const order = Object.keys(NAMES);
      theme = order[(order.indexOf(theme) + 1) % order.length];
      apply(theme);
      remember(theme);
      show();
    });
    button.hidden = false;
    show();
  });
})();
