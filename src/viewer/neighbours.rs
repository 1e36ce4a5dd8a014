//! Other daemons on the bus, and where their pages are.

use palpate_proto::keys::{INFO_EVERYWHERE, parse_live};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use tokio::sync::oneshot;
use zenoh::Wait;
use zenoh::sample::SampleKind;

/// How long others are waited for before a page is answered without them.
const PATIENCE: Duration = Duration::from_millis(500);

/// Daemons by instance and id, as their liveliness tokens come and go.
#[derive(Clone)]
pub(super) struct Neighbours {
    session: zenoh::Session,
    own: String,
    daemons: Arc<Mutex<BTreeSet<(String, String)>>>,
    _subscriber: Arc<zenoh::pubsub::Subscriber<()>>,
}

impl Neighbours {
    pub(super) fn watch(session: &zenoh::Session, own: &str) -> zenoh::Result<Self> {
        let daemons = Arc::new(Mutex::new(BTreeSet::new()));
        let known = daemons.clone();
        let subscriber = session
            .liveliness()
            .declare_subscriber("palpate/*/@live/server/*")
            .history(true)
            .callback(move |sample| {
                if let Some((instance, _, id)) = parse_live(sample.key_expr().as_str()) {
                    let daemon = (instance.to_owned(), id.to_owned());
                    match sample.kind() {
                        SampleKind::Put => lock(&known).insert(daemon),
                        SampleKind::Delete => lock(&known).remove(&daemon),
                    };
                }
            })
            .wait()?;
        Ok(Self {
            session: session.clone(),
            own: own.to_owned(),
            daemons,
            _subscriber: Arc::new(subscriber),
        })
    }

    /// Instances on the bus by name, our own among them.
    pub(super) fn instances(&self) -> Vec<String> {
        let others: BTreeSet<String> = (lock(&self.daemons).iter())
            .map(|(instance, _)| instance.clone())
            .chain([self.own.clone()])
            .collect();
        others.into_iter().collect()
    }

    /// Addresses of the pages of other instances, as far as these answer soon.
    pub(super) async fn pages(&self) -> BTreeMap<String, String> {
        if self.instances().len() < 2 {
            return BTreeMap::new();
        }
        let (answer, answered) = oneshot::channel();
        let (session, own) = (self.session.clone(), self.own.clone());
        // Zenoh's waiting is not for a thread that serves pages.
        let asked = std::thread::Builder::new()
            .name("palpate-neighbours".into())
            .spawn(move || drop(answer.send(ask(&session, &own))));
        match asked {
            Ok(_) => answered.await.unwrap_or_default(),
            Err(_) => BTreeMap::new(),
        }
    }
}

fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

fn ask(session: &zenoh::Session, own: &str) -> BTreeMap<String, String> {
    let mut pages = BTreeMap::new();
    let asked = session
        .get(INFO_EVERYWHERE)
        .consolidation(zenoh::query::ConsolidationMode::None)
        .timeout(PATIENCE)
        .wait();
    let Ok(replies) = asked else {
        return pages;
    };
    while let Ok(reply) = replies.recv() {
        let Ok(sample) = reply.result() else { continue };
        let Ok(info) = serde_json::from_slice::<serde_json::Value>(&sample.payload().to_bytes())
        else {
            continue;
        };
        if let (Some(name), Some(url)) = (info["instance"].as_str(), info["viewer"].as_str())
            && name != own
            // Whatever is on the bus may claim to be one.
            && url.starts_with("http://")
        {
            pages.insert(name.to_owned(), url.to_owned());
        }
    }
    pages
}
