//! Pressures as unknowns of the step beside the places.
//!
//! A pressure that is computed from a guess, λ (J − 1), multiplies the error of the guess by λ. With one unknown q for
//! each cell, and one for each patch, its gap c = J − 1 − q / λ is condensed onto the matrix of places instead:
//! the right-hand side loses Σ G₀ λ c, and a correction d of places changes q by λ (c + s G₀·d / V), G₀ = ∂V/∂x
//! where the matrix was made. The rate of such steps does not depend on λ (Hadjicharalambous et al. 2014).

use super::ContinuumLaw;
#[cfg(test)]
use super::Points;
use super::kernel::CellBlock;
use palpate_geometry::math::lanes::{Baseline, Four, Lanes};
use palpate_geometry::math::{Lane, Vector3};

/// ∂V/∂x of four cells where a matrix was made, m² (corner, axis).
pub(in crate::body) type Growth = [[Four; 3]; 8];

impl ContinuumLaw {
    /// Lanes of pressures and of their gaps: four cells each, then four patches each.
    pub(in crate::body) fn pressure_lanes(&self) -> usize {
        self.blocks.len() + self.patches.len().div_ceil(4)
    }

    /// Pressures as the volumes at `places` have them, q = λ (J − 1), Pa.
    #[cfg(test)]
    pub(in crate::body) fn pressures_at(&self, places: &[Lane], out: &mut [Lane]) {
        debug_assert_eq!(out.len(), self.pressure_lanes(), "a pressure a cell");
        let (of_cells, of_patches) = out.split_at_mut(self.blocks.len());
        for (block, q) in self.blocks.iter().zip(of_cells) {
            let volume = match self.points {
                Points::Eight => super::block::volumes(block, places),
                Points::Centre => super::centre::volumes(block, places),
            };
            let grown = super::kernel::grown(block, Baseline::load(&volume));
            (grown * Baseline::load(&block.bulk_pa)).store(q);
        }
        let of_patches = of_patches.as_flattened_mut();
        for (patch, q) in self.patches.iter().zip(of_patches) {
            *q = patch.pressure_pa(&self.blocks, places);
        }
    }

    /// Growth of the cells' volumes at `places` (nodes).
    pub(in crate::body) fn growth_at(&self, places: &[Lane]) -> Vec<Growth> {
        let at = |node: u32| {
            let [x, y, z, _] = places[node as usize];
            Vector3::new(x, y, z)
        };
        let mut growth = vec![[[[0.0; 4]; 3]; 8]; self.blocks.len()];
        for (block, growth) in self.blocks.iter().zip(&mut growth) {
            for k in 0..block.count {
                let cell = block.nodes.map(|four| four[k]);
                let of_corners = self.volume_derivatives(&cell.map(at)).1;
                for (to, g) in growth.iter_mut().zip(of_corners) {
                    for (to, value) in to.iter_mut().zip(g.iter()) {
                        to[k] = value * block.winding[k];
                    }
                }
            }
        }
        growth
    }

    /// Takes Σ G₀ λ c from `loads` (nodes), N, in the frame of the matrix.
    pub(in crate::body) fn condense(&self, growth: &[Growth], gaps: &[Lane], loads: &mut [Lane]) {
        debug_assert_eq!(growth.len(), self.blocks.len(), "a growth a block");
        #[cfg(target_arch = "x86_64")]
        if palpate_geometry::math::simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { condense_wide(self, growth, gaps, loads) };
        }
        self.condense_in::<Baseline>(growth, gaps, loads);
    }

    #[inline(always)]
    fn condense_in<L: Lanes>(&self, growth: &[Growth], gaps: &[Lane], loads: &mut [Lane]) {
        let (of_cells, of_patches) = gaps.split_at(self.blocks.len());
        if self.patches.is_empty() {
            for ((block, growth), gap) in self.blocks.iter().zip(growth).zip(of_cells) {
                let amount = L::load(&block.bulk_pa) * L::load(gap);
                take::<L>(block, growth, amount, loads);
            }
            return;
        }
        for (patch, gap) in self.patches.iter().zip(of_patches.as_flattened()) {
            let shared = L::splat(patch.lame_pa * gap);
            for k in patch.first..patch.first + patch.count {
                let block = &self.blocks[k];
                let amount = L::load(&block.bulk_pa) * L::load(&of_cells[k]) + shared;
                take::<L>(block, &growth[k], amount, loads);
            }
        }
    }

    /// Changes pressures (Pa) by λ (c + s G₀·d / V): `moved` is d of the nodes, m, in the frame of the matrix, `share` is
    /// s. Without gaps c is zero.
    pub(in crate::body) fn press(
        &self,
        growth: &[Growth],
        moved: &[Lane],
        share: f64,
        gaps: Option<&[Lane]>,
        pressures: &mut [Lane],
    ) {
        #[cfg(target_arch = "x86_64")]
        if palpate_geometry::math::simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { press_wide(self, growth, moved, share, gaps, pressures) };
        }
        self.press_in::<Baseline>(growth, moved, share, gaps, pressures);
    }

    #[inline(always)]
    fn press_in<L: Lanes>(
        &self,
        growth: &[Growth],
        moved: &[Lane],
        share: f64,
        gaps: Option<&[Lane]>,
        pressures: &mut [Lane],
    ) {
        let count = self.blocks.len();
        let (of_cells, of_patches) = pressures.split_at_mut(count);
        let of_patches = of_patches.as_flattened_mut();
        let mut sums = of_patches.iter_mut().zip(&self.patches).enumerate();
        let (mut patch, mut grown) = (sums.next(), 0.0);
        for (k, (block, growth)) in self.blocks.iter().zip(growth).enumerate() {
            let volume = grown_by::<L>(block, growth, moved);
            let relative = volume * L::load(&block.per_volume) * L::load(&block.winding);
            let mut change = relative * L::splat(share);
            if let Some(gaps) = gaps {
                change = change + L::load(&gaps[k]);
            }
            let q = L::load(&of_cells[k]) + L::load(&block.bulk_pa) * change;
            q.store(&mut of_cells[k]);
            let Some((number, (shared, of))) = &mut patch else {
                continue;
            };
            let mut of_block: Four = [0.0; 4];
            volume.store(&mut of_block);
            grown += of_block[..block.count].iter().sum::<f64>();
            if k + 1 == of.first + of.count {
                let gap = gaps.map_or(0.0, |gaps| gaps[count..].as_flattened()[*number]);
                **shared += of.lame_pa * (gap + share * grown / of.volume_m3);
                (patch, grown) = (sums.next(), 0.0);
            }
        }
    }
}

/// Takes G₀ times an amount (Pa) of each cell from the nodes' loads.
#[inline(always)]
fn take<L: Lanes>(block: &CellBlock, growth: &Growth, amount: L, loads: &mut [Lane]) {
    for (nodes, g) in block.nodes.iter().zip(growth) {
        let along = |axis: usize| L::load(&g[axis]) * amount;
        let rows = L::transposed([along(0), along(1), along(2), L::splat(0.0)]);
        for (row, &node) in rows.into_iter().zip(nodes) {
            let lane = &mut loads[node as usize];
            (L::load(lane) - row).store(lane);
        }
    }
}

/// G₀·d of each cell, m³.
#[inline(always)]
fn grown_by<L: Lanes>(block: &CellBlock, growth: &Growth, moved: &[Lane]) -> L {
    let mut sum = L::splat(0.0);
    for (nodes, g) in block.nodes.iter().zip(growth) {
        let at = |k: usize| L::load(&moved[nodes[k] as usize]);
        let rows = L::transposed([at(0), at(1), at(2), at(3)]);
        let along = L::load(&g[0]) * rows[0] + L::load(&g[1]) * rows[1];
        sum = sum + (along + L::load(&g[2]) * rows[2]);
    }
    sum
}

/// The same code with 256-bit registers; no fused multiply-add, so the bits are the same.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn condense_wide(law: &ContinuumLaw, growth: &[Growth], gaps: &[Lane], loads: &mut [Lane]) {
    law.condense_in::<palpate_geometry::math::lanes::Wide>(growth, gaps, loads);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn press_wide(
    law: &ContinuumLaw,
    growth: &[Growth],
    moved: &[Lane],
    share: f64,
    gaps: Option<&[Lane]>,
    pressures: &mut [Lane],
) {
    law.press_in::<palpate_geometry::math::lanes::Wide>(growth, moved, share, gaps, pressures);
}
