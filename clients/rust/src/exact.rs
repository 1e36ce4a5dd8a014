//! One key, or a pattern.

use zenoh::key_expr::keyexpr;

/// True if a message or query names one key, false if its key is a pattern (`*`, `**`, `$*`).
///
/// Zenoh carries a message put under `palpate/**` to every subscriber that the pattern matches, and a query
/// for it to every queryable. Questions may be asked like that. What moves a tool, gives a command or says
/// what a force is must have named its key: whoever receives it asks this first.
///
/// ```
/// use palpate_client::is_one_key;
/// use zenoh::key_expr::KeyExpr;
/// let key = |text: &'static str| KeyExpr::try_from(text).unwrap();
/// assert!(is_one_key(&key("palpate/default/rpc/pause")));
/// assert!(!is_one_key(&key("palpate/default/rpc/*")));
/// assert!(!is_one_key(&key("palpate/default/rpc/pau$*")));
/// ```
pub fn is_one_key(key: &keyexpr) -> bool {
    !key.is_wild()
}
