//! What can be wrong with the deforming part of a `[[body]]`.

use super::Check;
use crate::body::{MOST_NODES_A_SIDE, PRESETS};
use crate::scene::spec::{BodySpec, FixedSpec, MaterialSpec, RegionSpec};

impl Check<'_> {
    pub(super) fn deforming(&mut self, b: usize, body: &BodySpec) {
        self.material(b, &body.material);
        for (r, region) in body.regions.iter().enumerate() {
            self.region(b, r, region);
        }
        if body.lattice.layers == 0 {
            self.refuse("body", b, "layers", "layers is 0; a lattice has at least 1");
        }
        if let Some(thickness) = body.lattice.thickness_m {
            self.above_zero("body", b, "thickness_m", thickness, "m");
        }
        if body
            .lattice
            .nodes
            .iter()
            .any(|n| !(2..=MOST_NODES_A_SIDE).contains(n))
        {
            let message = format!(
                "nodes is {:?}; each must be 2 to {MOST_NODES_A_SIDE}",
                body.lattice.nodes
            );
            self.refuse("body", b, "nodes", message);
        }
        self.within(b, "cycles", body.lattice.cycles, 10_000);
        self.within(b, "cells_per_span", body.lattice.cells_per_span, 8);
        if let Some(layers) = body.lattice.cell_layers {
            self.within(b, "cell_layers", layers, 64);
        }
        let integrator = &body.integrator;
        self.within(b, "iterations", integrator.iterations, 10);
        self.within(b, "substeps", integrator.substeps, 1_000);
        self.within(b, "contact_sweeps", integrator.contact_sweeps, 1_000);
        self.within(b, "every", integrator.every as usize, 100);
        if integrator.iterations > 1 && integrator.every > 1 {
            let message = format!(
                "iterations is {} and every is {}: contact is settled between the iterations of one tick; give one of them 1",
                integrator.iterations, integrator.every
            );
            self.refuse("body", b, "iterations", message);
        }
        self.not_below_zero("body", b, "sleep_m_s", integrator.sleep_m_s, "m/s");
        for fixed in &body.fixed {
            match fixed {
                FixedSpec::Plane { point, normal } => {
                    self.finite("body", b, "point", point);
                    self.direction("body", b, "normal", normal);
                }
                FixedSpec::Range { u, v } => {
                    if [u, v]
                        .iter()
                        .any(|[from, to]| from.is_nan() || to.is_nan() || from > to)
                    {
                        let message = format!(
                            "u = {u:?}, v = {v:?} is no range; give [from, to] with from <= to"
                        );
                        self.refuse("body", b, "fixed", message);
                    }
                }
            }
        }
    }

    fn within(&mut self, b: usize, key: &str, value: usize, most: usize) {
        if !(1..=most).contains(&value) {
            self.refuse(
                "body",
                b,
                key,
                format!("{key} is {value}; it must be 1 to {most}"),
            );
        }
    }

    fn material(&mut self, b: usize, material: &MaterialSpec) {
        if let Some(name) = &material.preset
            && crate::body::preset(name).is_none()
        {
            let known: Vec<&str> = PRESETS.iter().map(|preset| preset.name).collect();
            let near = known
                .iter()
                .min_by_key(|known| strsim::damerau_levenshtein(name, known))
                .unwrap_or(&"");
            let message = format!(
                "{name:?} is no material; did you mean {near:?}? (known: {})",
                known.join(", ")
            );
            self.refuse("body", b, "preset", message);
        }
        self.moduli(
            b,
            material.young_pa,
            material.poisson,
            material.density_kg_m3,
        );
        if let Some(damping_s) = material.damping_s {
            self.not_below_zero("body", b, "damping_s", damping_s, "s");
        }
        if let Some(plastic) = &material.plastic {
            self.not_below_zero("body", b, "yield_strain", plastic.yield_strain, "");
            self.not_below_zero("body", b, "rate_per_s", plastic.rate_per_s, "1/s");
            self.not_below_zero("body", b, "hardening", plastic.hardening, "");
            self.not_below_zero("body", b, "spread_m", plastic.spread_m, "m");
            if !(plastic.limit > 0.0 && plastic.limit < 1.0) {
                let message = format!("limit is {}; it must be above 0 and below 1", plastic.limit);
                self.refuse("body", b, "limit", message);
            }
        }
        if let Some(law) = &material.stiffening {
            for (key, ratio) in [
                ("ratio", law.ratio),
                ("least_length_ratio", law.least_length_ratio),
            ] {
                if !(1.0..=1_000.0).contains(&ratio) {
                    self.refuse(
                        "body",
                        b,
                        key,
                        format!("{key} is {ratio}; it must be 1 to 1000"),
                    );
                }
            }
            if law.strain.is_nan() || law.strain < 0.0 {
                self.refuse(
                    "body",
                    b,
                    "strain",
                    format!("strain is {}; it must be at least 0", law.strain),
                );
            }
            if !(0.0..1.0).contains(&law.least_length) {
                let message = format!(
                    "least_length is {}; it must be at least 0 and below 1",
                    law.least_length
                );
                self.refuse("body", b, "least_length", message);
            }
        }
    }

    fn moduli(
        &mut self,
        b: usize,
        young_pa: Option<f64>,
        poisson: Option<f64>,
        density_kg_m3: Option<f64>,
    ) {
        if let Some(young_pa) = young_pa {
            self.above_zero("body", b, "young_pa", young_pa, "Pa");
        }
        if let Some(density) = density_kg_m3 {
            self.above_zero("body", b, "density_kg_m3", density, "kg/m³");
        }
        if let Some(poisson) = poisson
            && !(0.0..0.5).contains(&poisson)
        {
            let message = format!("poisson is {poisson}; it must be at least 0 and below 0.5");
            self.refuse("body", b, "poisson", message);
        }
    }

    fn region(&mut self, b: usize, r: usize, region: &RegionSpec) {
        self.moduli(b, region.young_pa, region.poisson, region.density_kg_m3);
        if region.ball.is_some() == region.box_.is_some() {
            self.refuse_part(
                "body",
                b,
                "region",
                r,
                "a region needs exactly one of ball, box",
            );
        }
        if let Some(ball) = &region.ball {
            self.finite("body", b, "centre", &ball.centre);
            self.above_zero("body", b, "radius_m", ball.radius_m, "m");
        }
        if let Some(bounds) = &region.box_
            && (0..3).any(|c| {
                bounds.low[c]
                    .partial_cmp(&bounds.high[c])
                    .is_none_or(|order| order.is_ge())
            })
        {
            let message = format!(
                "low = {:?} must be below high = {:?} in x, y and z",
                bounds.low, bounds.high
            );
            self.refuse("body", b, "low", message);
        }
    }
}
