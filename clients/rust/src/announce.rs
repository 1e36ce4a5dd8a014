//! A description that every daemon gets: the one there is, and the one that comes after it.

use crate::connection::ClientError;
use crate::publish::publisher;
use palpate_proto::codec::encode;
use palpate_proto::messages::DeviceInfo;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use zenoh::Wait;
use zenoh::matching::MatchingListener;
use zenoh::pubsub::Publisher;

pub(crate) struct Announcement {
    bytes: Vec<u8>,
    /// Who tells it.
    holder: Vec<u8>,
    /// A daemon appeared that does not have the description yet.
    due: Arc<AtomicBool>,
    // Fields are dropped in this order: a publisher that goes takes its listeners along.
    _listener: MatchingListener<()>,
    publisher: Publisher<'static>,
}

impl Announcement {
    pub(crate) fn new(
        session: &zenoh::Session,
        key: &str,
        info: &DeviceInfo,
        holder: Vec<u8>,
    ) -> Result<Self, ClientError> {
        let publisher =
            publisher::<DeviceInfo>(session, key.to_owned()).map_err(ClientError::zenoh)?;
        let due = Arc::new(AtomicBool::new(false));
        let appeared = due.clone();
        let listener = publisher
            .matching_listener()
            .callback(move |status| {
                if status.matching() {
                    appeared.store(true, Ordering::Release);
                }
            })
            .wait()
            .map_err(ClientError::zenoh)?;
        let announcement = Self {
            bytes: encode(info),
            holder,
            due,
            publisher,
            _listener: listener,
        };
        announcement.put()?;
        Ok(announcement)
    }

    /// Tells another description from now on.
    pub(crate) fn replace(&mut self, info: &DeviceInfo) -> Result<(), ClientError> {
        self.bytes = encode(info);
        self.put()
    }

    /// Tells a daemon that has appeared.
    pub(crate) fn repeat_if_due(&self) -> Result<(), ClientError> {
        if self.due.swap(false, Ordering::AcqRel) {
            self.put()
        } else {
            Ok(())
        }
    }

    fn put(&self) -> Result<(), ClientError> {
        self.publisher
            .put(self.bytes.clone())
            .attachment(&self.holder)
            .wait()
            .map_err(ClientError::zenoh)
    }
}
