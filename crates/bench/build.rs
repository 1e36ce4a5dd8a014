//! Links the C and C++ libraries that run as peers when their features are on.

fn main() {
    println!("cargo::rerun-if-changed=src/peers/occt.cpp");
    if std::env::var_os("CARGO_FEATURE_SISL").is_some() {
        println!("cargo::rustc-link-lib=static=sisl");
        println!("cargo::rustc-link-search=native=/usr/lib");
    }
    #[cfg(feature = "occt")]
    {
        cc::Build::new()
            .cpp(true)
            .std("c++17")
            .include("/usr/include/opencascade")
            .flag_if_supported("-Wno-deprecated-declarations")
            .file("src/peers/occt.cpp")
            .compile("palpate_occt");
        for library in [
            "TKShHealing",
            "TKTopAlgo",
            "TKBRep",
            "TKGeomAlgo",
            "TKGeomBase",
            "TKG3d",
            "TKG2d",
            "TKMath",
            "TKernel",
        ] {
            println!("cargo::rustc-link-lib={library}");
        }
    }
}
