//! Which vector instructions this run may use.
//!
//! Wider registers must not change a bit: functions compiled for them are the baseline's own code
//! with more lanes, never with fused multiply-add. `PALPATE_SIMD=baseline` holds a run to the
//! baseline, so that tests can compare.

use std::sync::OnceLock;

/// True when functions compiled for AVX2 and F16C may be called; processors with the first have the
/// second. Asked of the processor once.
#[cfg(target_arch = "x86_64")]
pub fn has_avx2() -> bool {
    static ANSWER: OnceLock<bool> = OnceLock::new();
    *ANSWER.get_or_init(|| {
        let held_back = std::env::var("PALPATE_SIMD").is_ok_and(|value| value == "baseline");
        !held_back
            && std::arch::is_x86_feature_detected!("avx2")
            && std::arch::is_x86_feature_detected!("f16c")
    })
}

/// The code path used by this run, as noted in recordings.
pub fn path_name() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    if has_avx2() {
        return "avx2";
    }
    "baseline"
}
