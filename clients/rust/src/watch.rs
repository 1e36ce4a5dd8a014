//! What is on the bus, of whatever kind: for tools that look at it.

use crate::connection::{ClientError, Palpate};
use palpate_proto::any;
use std::time::{Duration, Instant};
use zenoh::Wait;
use zenoh::query::ConsolidationMode;

/// A message as it came.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Seen {
    /// Key expression.
    pub key: String,
    /// Its encoding, as Zenoh writes it.
    pub encoding: String,
    /// Payload of the message.
    pub bytes: Vec<u8>,
}

impl Seen {
    fn new(sample: &zenoh::sample::Sample) -> Self {
        Self {
            key: sample.key_expr().to_string(),
            encoding: sample.encoding().to_string(),
            bytes: sample.payload().to_bytes().into_owned(),
        }
    }

    /// Schema part of the encoding; empty when it has none.
    pub fn schema(&self) -> &str {
        self.encoding
            .split_once(';')
            .map_or("", |(_, schema)| schema)
    }

    /// Versioned name of the message: from its schema, or where there is none from its key.
    pub fn name(&self) -> Option<&str> {
        match self.schema() {
            "" => any::name_of_key(&self.key),
            schema => schema.strip_prefix("postcard;"),
        }
    }

    /// The message as JSON; `None` where it is not one of ours, or not of this version.
    pub fn to_json(&self) -> Option<serde_json::Value> {
        any::to_json(self.name()?, &self.bytes)?.ok()
    }
}

impl Palpate {
    /// Calls `take` on each message under a key (expression), on a receive thread: be quick. Ends
    /// when dropped.
    ///
    /// # Errors
    /// No key, or Zenoh refused.
    pub fn watch(
        &self,
        key: &str,
        take: impl Fn(Seen) + Send + Sync + 'static,
    ) -> Result<zenoh::pubsub::Subscriber<()>, ClientError> {
        let callback = move |sample: zenoh::sample::Sample| {
            if sample.kind() == zenoh::sample::SampleKind::Put {
                take(Seen::new(&sample));
            }
        };
        self.session()
            .declare_subscriber(key.to_owned())
            .callback(callback)
            .wait()
            .map_err(ClientError::zenoh)
    }

    /// All replies to a query; an empty list is not an error.
    ///
    /// # Errors
    /// No key, Zenoh refused, or a daemon did, in its words.
    pub fn ask(&self, selector: &str, timeout: Duration) -> Result<Vec<Seen>, ClientError> {
        let (key, parameters) = selector.split_once('?').unwrap_or((selector, ""));
        let querier = self
            .session()
            .declare_querier(key.to_owned())
            // Several answers under one key are all wanted.
            .consolidation(ConsolidationMode::None)
            .timeout(timeout)
            .wait()
            .map_err(ClientError::zenoh)?;
        let started = Instant::now();
        loop {
            // A fresh link may not have carried the daemon's declarations yet: then nobody has said
            // nothing.
            let known = querier
                .matching_status()
                .wait()
                .map_err(ClientError::zenoh)?
                .matching();
            let replies = querier
                .get()
                .parameters(parameters)
                .wait()
                .map_err(ClientError::zenoh)?;
            let mut answers = Vec::new();
            while let Ok(reply) = replies.recv() {
                match reply.result() {
                    Ok(sample) => answers.push(Seen::new(sample)),
                    Err(error) => {
                        if let Some(reason) = ClientError::words(error) {
                            return Err(ClientError::Refused {
                                method: selector.to_owned(),
                                reason,
                            });
                        }
                    }
                }
            }
            if known || !answers.is_empty() || started.elapsed() >= timeout {
                return Ok(answers);
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Keys of the liveliness tokens that match, asked until `enough` says so or the time is over.
    ///
    /// # Errors
    /// No key, or Zenoh refused.
    pub fn live(
        &self,
        key: &str,
        timeout: Duration,
        enough: impl Fn(&[String]) -> bool,
    ) -> Result<Vec<String>, ClientError> {
        let started = Instant::now();
        loop {
            let replies = self
                .session()
                .liveliness()
                .get(key)
                .timeout(timeout)
                .wait()
                .map_err(ClientError::zenoh)?;
            let mut keys = Vec::new();
            while let Ok(reply) = replies.recv() {
                keys.extend(
                    reply
                        .result()
                        .ok()
                        .map(|sample| sample.key_expr().to_string()),
                );
            }
            keys.sort();
            keys.dedup();
            if enough(&keys) || started.elapsed() >= timeout {
                return Ok(keys);
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}
