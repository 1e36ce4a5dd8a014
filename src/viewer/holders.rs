//! Who holds which tool, as pages show it.

use super::board::{Board, Lasts};
use super::frames::json_frame;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Number of a socket.
pub(super) type Socket = u64;

#[derive(Debug, Default)]
struct Holder {
    /// A liveliness token of the tool is on the bus: someone's, perhaps a page's.
    token: bool,
    /// Name of its device, as the bus has it.
    device: Option<String>,
    /// The page that holds it, and what it calls itself.
    page: Option<(Socket, String)>,
}

impl Holder {
    fn who(&self) -> Option<&str> {
        match (&self.page, self.token) {
            (Some((_, name)), _) => Some(name),
            (None, true) => Some(self.device.as_deref().unwrap_or("a client on the bus")),
            (None, false) => None,
        }
    }
}

/// By tool. Each change is posted as `holders`.
pub(super) struct Holders {
    tools: Mutex<BTreeMap<String, Holder>>,
    board: Arc<Board>,
}

impl Holders {
    pub(super) fn new(tools: &[String], board: Arc<Board>) -> Self {
        let free = tools.iter().map(|tool| (tool.clone(), Holder::default()));
        let holders = Self {
            tools: Mutex::new(free.collect()),
            board,
        };
        holders.change(|_| ());
        holders
    }

    fn lock(&self) -> MutexGuard<'_, BTreeMap<String, Holder>> {
        self.tools.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn change<T>(&self, change: impl FnOnce(&mut BTreeMap<String, Holder>) -> T) -> T {
        let mut tools = self.lock();
        let done = change(&mut tools);
        let who: BTreeMap<&str, Option<&str>> = (tools.iter())
            .map(|(id, holder)| (id.as_str(), holder.who()))
            .collect();
        let frame = json_frame("holders", &who);
        self.board.post_frame("holders", Lasts::UntilChanged, frame);
        done
    }

    /// A token appeared on the bus, or disappeared.
    pub(super) fn token(&self, tool: &str, present: bool) {
        self.change(|tools| {
            if let Some(holder) = tools.get_mut(tool) {
                holder.token = present;
                if !present {
                    holder.device = None;
                }
            }
        });
    }

    /// A device was described on the bus.
    pub(super) fn device(&self, tool: &str, name: &str) {
        self.change(|tools| {
            if let Some(holder) = tools.get_mut(tool) {
                holder.device = Some(name.to_owned());
            }
        });
    }

    /// A page wants a tool. True if it has it already.
    ///
    /// # Errors
    /// There is no such tool, or who holds it.
    pub(super) fn claim(&self, socket: Socket, tool: &str, name: &str) -> Result<bool, String> {
        self.change(|tools| {
            let known = || tools.keys().cloned().collect::<Vec<_>>().join(", ");
            let Some(holder) = tools.get(tool) else {
                return Err(format!(
                    "this scene has no tool {tool:?}; it has {}",
                    known()
                ));
            };
            match (&holder.page, holder.who()) {
                (Some((owner, _)), _) if *owner == socket => return Ok(true),
                (_, Some(who)) => return Err(format!("tool {tool:?} is held by {who}")),
                (_, None) => {}
            }
            if let Some(holder) = tools.get_mut(tool) {
                holder.page = Some((socket, name.to_owned()));
            }
            Ok(false)
        })
    }

    /// This page holds the tool.
    pub(super) fn holds(&self, socket: Socket, tool: &str) -> bool {
        let tools = self.lock();
        let page = tools.get(tool).and_then(|holder| holder.page.as_ref());
        page.is_some_and(|(owner, _)| *owner == socket)
    }

    /// A page gives a tool back.
    pub(super) fn release(&self, tool: &str) {
        self.change(|tools| {
            if let Some(holder) = tools.get_mut(tool) {
                // Its token goes with it: the next page need not wait until the bus says so.
                *holder = Holder::default();
            }
        });
    }

    /// The tools of a page.
    pub(super) fn of(&self, socket: Socket) -> Vec<String> {
        let tools = self.lock();
        let mine = tools.iter().filter(|(_, holder)| {
            (holder.page.as_ref()).is_some_and(|(owner, _)| *owner == socket)
        });
        mine.map(|(id, _)| id.clone()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tool_has_one_holder_and_the_next_is_told_who_it_is() {
        let tools = ["ball".to_owned(), "pen".to_owned()];
        let holders = Holders::new(&tools, Arc::new(Board::new()));
        assert_eq!(holders.claim(1, "ball", "mouse A"), Ok(false));
        assert_eq!(holders.claim(1, "ball", "mouse A"), Ok(true));
        let refused = holders.claim(2, "ball", "mouse B").unwrap_err();
        assert!(refused.contains("mouse A"), "{refused}");
        let refused = holders.claim(2, "saw", "mouse B").unwrap_err();
        assert!(refused.contains("ball, pen"), "{refused}");
        assert!(holders.holds(1, "ball") && !holders.holds(2, "ball"));
        assert_eq!(holders.of(1), ["ball"]);
        holders.release("ball");
        assert_eq!(holders.claim(2, "ball", "mouse B"), Ok(false));
    }

    #[test]
    fn a_client_on_the_bus_holds_its_tool_until_its_token_goes() {
        let holders = Holders::new(&["ball".to_owned()], Arc::new(Board::new()));
        holders.token("ball", true);
        let refused = holders.claim(1, "ball", "mouse").unwrap_err();
        assert!(refused.contains("a client on the bus"), "{refused}");
        holders.device("ball", "omega.3");
        let refused = holders.claim(1, "ball", "mouse").unwrap_err();
        assert!(refused.contains("omega.3"), "{refused}");
        holders.token("ball", false);
        assert_eq!(holders.claim(1, "ball", "mouse"), Ok(false));
    }
}
