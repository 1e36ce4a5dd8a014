//! How queries are answered.

use palpate_client::encoding;
use palpate_proto::codec::encode;
use palpate_proto::messages::Message;
use palpate_proto::rpc::Answer;
use zenoh::Wait;
use zenoh::bytes::Encoding;
use zenoh::key_expr::KeyExpr;
use zenoh::query::Query;

/// Answers with a message, under the key of the query.
pub(super) fn reply<M: Message>(query: &Query, message: &M) {
    let _ = query
        .reply(query.key_expr().clone(), encode(message))
        .encoding(encoding::<M>())
        .wait();
}

/// Answers under a key with JSON.
pub(super) fn reply_json(query: &Query, key: KeyExpr<'static>, value: &impl serde::Serialize) {
    let text = serde_json::to_string(value).unwrap_or_default();
    let _ = query
        .reply(key, text)
        .encoding(Encoding::APPLICATION_JSON)
        .wait();
}

/// Answers a command.
pub(super) fn reply_to_call(query: &Query, answer: &Answer) {
    reply_json(query, query.key_expr().clone(), answer);
}

/// Answers with an error: JSON like that of a refused command.
pub(super) fn reply_refused(query: &Query, reason: &str) {
    let text = serde_json::to_string(&Answer::<()>::refused(reason)).unwrap_or_default();
    let _ = query
        .reply_err(text)
        .encoding(Encoding::APPLICATION_JSON)
        .wait();
}
