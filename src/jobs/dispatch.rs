//! How a queued job's id reaches a worker.

use async_trait::async_trait;
use tokio::sync::Mutex;
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};
use tokio_util::sync::CancellationToken;

use crate::store::records::Id;

/// Carries ids from those who queue jobs to those who run them. An id may be delivered twice, or late: the store says
/// whether its job still waits.
#[async_trait]
pub trait Dispatch: Send + Sync {
    /// Tells a worker that a job is queued, once the store has it.
    async fn publish(&self, id: Id);
    /// The next id, once there is one; `None` after [`Dispatch::close`]. No id is lost when the wait is given up.
    async fn next(&self) -> Option<Id>;
    /// Ends every wait, now and later. Ids that nobody took stay queued in the store.
    fn close(&self);
}

/// Dispatch within one process. What waits here are ids: those of queued jobs, and those of cancelled ones until a
/// worker has skipped them.
#[derive(Debug)]
pub struct InProcess {
    sender: UnboundedSender<Id>,
    receiver: Mutex<UnboundedReceiver<Id>>,
    closed: CancellationToken,
}

impl Default for InProcess {
    fn default() -> Self {
        let (sender, receiver) = unbounded_channel();
        Self { sender, receiver: Mutex::new(receiver), closed: CancellationToken::new() }
    }
}

#[async_trait]
impl Dispatch for InProcess {
    async fn publish(&self, id: Id) {
        self.sender.send(id).expect("the receiver lives as long as the sender");
    }

    async fn next(&self) -> Option<Id> {
        let receive = async { self.receiver.lock().await.recv().await };
        tokio::select! {
            biased;
            () = self.closed.cancelled() => None,
            id = receive => id,
        }
    }

    fn close(&self) {
        self.closed.cancel();
    }
}
