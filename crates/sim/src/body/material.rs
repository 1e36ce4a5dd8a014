//! What bodies are made of, SI only.

/// A material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Young's modulus E, Pa.
    pub young_pa: f64,
    /// Poisson's ratio ν, for `continuum`; springs can only mean 1/4 (1/3 in membranes).
    pub poisson: f64,
    /// ρ, kg/m³.
    pub density_kg_m3: f64,
    /// d, s: a strain rate adds the stress of a strain of `d` times itself.
    pub damping_s: f64,
    /// Springs or cells that give for good.
    pub plastic: Option<Plastic>,
    /// Springs that stiffen.
    pub stiffening: Option<Stiffening>,
}

/// Plastic flow: beyond the yield strain, the rest length of a spring or the rest shape of a cell
/// follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plastic {
    /// Strain up to which nothing flows: of a spring, or of a bar of the material that is drawn.
    pub yield_strain: f64,
    /// Share of the strain beyond yield that flows away in a second, 1/s.
    pub rate_per_s: f64,
    /// Growth of the yield strain with the plastic strain so far.
    pub hardening: f64,
    /// Most plastic change of a length, relative to that at first, below 1.
    pub limit: f64,
    /// Flow is shared with springs or cells within this distance, m; 0 keeps it where it arises.
    pub spread_m: f64,
}

/// Springs with three slopes: soft in the middle, stiffer far out, and stiff when nearly closed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiffening {
    /// Strain in extension from which on they are stiffer; infinite for never.
    pub strain: f64,
    /// Stiffness there, relative to that at rest, ≥ 1.
    pub ratio: f64,
    /// Length below which coils touch, relative to the rest length, in [0, 1).
    pub least_length: f64,
    /// Stiffness there, relative to that at rest, ≥ 1.
    pub least_length_ratio: f64,
}

impl Stiffening {
    /// Greatest slope, relative to that at rest.
    pub fn greatest_ratio(&self) -> f64 {
        let closed = if self.least_length > 0.0 {
            self.least_length_ratio
        } else {
            1.0
        };
        let far = if self.strain.is_finite() {
            self.ratio
        } else {
            1.0
        };
        closed.max(far).max(1.0)
    }
}

/// A material with a name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// As scenes name it.
    pub name: &'static str,
    /// Its values.
    pub material: Material,
    /// Where they come from.
    pub source: &'static str,
}

const fn elastic(young_pa: f64, poisson: f64, density_kg_m3: f64, damping_s: f64) -> Material {
    Material {
        young_pa,
        poisson,
        density_kg_m3,
        damping_s,
        plastic: None,
        stiffening: None,
    }
}

/// All presets. Moduli of soft matter scatter by a factor of two and more between samples: these
/// are places to start from.
pub const PRESETS: [Preset; 7] = [
    Preset {
        name: "gel",
        material: elastic(20e3, 0.3, 1_000.0, 2e-3),
        source: "round values of a soft gel; the default, and that of the published comparisons",
    },
    Preset {
        name: "jelly",
        material: elastic(6e3, 0.45, 1_050.0, 4e-3),
        source: "dessert gelatine of about 5 % by mass: some kPa, close to water in density and in volume",
    },
    Preset {
        name: "soft-tissue",
        material: elastic(5e3, 0.45, 1_060.0, 5e-3),
        source: "liver, 0.4 to 6 kPa in Wells & Liang 2011, J. R. Soc. Interface 8:1521; density of liver 1,060 kg/m3",
    },
    Preset {
        name: "silicone",
        material: elastic(69e3, 0.47, 1_070.0, 2e-3),
        source: "Ecoflex 00-30, data sheet: modulus at 100 % strain 69 kPa, specific gravity 1.07",
    },
    Preset {
        name: "plasticine",
        material: Material {
            plastic: Some(Plastic {
                yield_strain: 0.01,
                rate_per_s: 20.0,
                hardening: 0.1,
                limit: 0.6,
                spread_m: 0.0,
            }),
            ..elastic(13e6, 0.3, 2_500.0, 1e-3)
        },
        source: "Pungotra 2010, figures 5.9 and 5.10: 13 MN/m2, 2,500 kg/m3; yield and flow are ours",
    },
    Preset {
        name: "rubber",
        material: elastic(2e6, 0.48, 1_100.0, 1e-3),
        source: "soft natural rubber, shear modulus 0.4 to 1 MPa (Gent, Engineering with Rubber, ch. 3)",
    },
    Preset {
        name: "steel",
        material: elastic(210e9, 0.3, 7_850.0, 1e-5),
        source: "EN 1993-1-1, 3.2.6",
    },
];

/// A preset by name.
pub fn preset(name: &str) -> Option<&'static Preset> {
    PRESETS.iter().find(|preset| preset.name == name)
}
