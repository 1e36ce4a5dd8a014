//! A body that deforms: its surface gives way as its implicit step does.

use super::body::{BodyScratch, BodyState, DeformingScratch, Of, Stepped, box_of};
use super::contract::{Around, Begun, Ended, Party, Problem};
use super::pipeline::Pipeline;
use crate::body::{
    Deformable, DeformableScratch, DeformableState, FallBack, Field, Following, Follows,
};
use crate::scene::{Body, DeformingBody};
use crate::solve::delassus::{Compliance, Delassus, Frame};
use crate::solve::indentation::Resolution;
use crate::solve::matrix::directions;
use crate::solve::rigid_part::RigidPart;
use crate::solve::rows::{DeformingView, Range, Row, RowSet};
use crate::solve::solver::Solver;
use crate::tick::quality;
use crate::tick::record::TickFault;
use palpate_geometry::math::{Point3, Vector3};
use std::iter::{empty, once};

/// A body as rows see it, when it deforms.
pub(crate) fn view<'a>(body: &'a Body, parts: &'a BodyScratch) -> Option<DeformingView<'a>> {
    let deforming = parts.deforming.as_ref()?;
    Some(DeformingView {
        surface: parts.skin.surface()?,
        predicted: &deforming.predicted_net,
        samples: &body.deforming()?.samples,
    })
}

/// How a body answers forces on its net in the step that a scratch stands for.
struct Answers<'a> {
    deformable: &'a Deformable,
    scratch: &'a DeformableScratch,
}

impl Compliance for Answers<'_> {
    fn column(&self, place: usize) -> &[[f32; 9]] {
        self.deformable.compliance_of(self.scratch, place)
    }

    fn frame(&self, place: usize) -> &Frame {
        self.deformable.frame_of(self.scratch, place)
    }

    fn rigid(&self) -> Option<&RigidPart> {
        self.deformable.rigid_part(self.scratch)
    }
}

impl Party for Of<'_, &DeformingBody> {
    type State = BodyState;
    type Scratch = BodyScratch;

    fn start(&self) -> BodyState {
        let deformable = &self.kind.deformable;
        let loads = match self.kind.every > 1 {
            true => deformable.coordinate_count(),
            false => 0,
        };
        let mut nodes = deformable.rest_state();
        if self.kind.every > 1 {
            // Where a step takes several ticks, making a matrix takes more than anyone waits for.
            nodes.following = Following::default();
        }
        BodyState {
            deformable: Some(nodes),
            loads: vec![Vector3::zeros(); loads],
            ..BodyState::default()
        }
    }

    fn scratch(&self) -> BodyScratch {
        let net = self.body.skin.points();
        BodyScratch {
            deforming: Some(DeformingScratch {
                deformable: self.kind.deformable.scratch(),
                predicted_net: net.to_vec(),
                change: vec![Vector3::zeros(); net.len()],
                stepped: Stepped::Here,
            }),
            ..BodyScratch::of(self.body)
        }
    }

    fn prepare(&self, field: Field, state: &BodyState, scratch: &mut BodyScratch, predicted: bool) {
        let BodyScratch {
            skin,
            solver,
            bounds,
            deforming,
            ..
        } = scratch;
        let (Some(deforming), Some(nodes), Some(surface)) =
            (deforming, &state.deformable, skin.surface_mut())
        else {
            return;
        };
        let deformable = &self.kind.deformable;
        deformable.set_field(&mut deforming.deformable, field);
        match predicted {
            false => deformable.predict(nodes, &mut deforming.deformable),
            true => deformable.follow(nodes, &mut deforming.deformable),
        }
        for (control, point) in surface.net_mut().points_mut().iter_mut().enumerate() {
            let node = deformable.coordinate_of_control(control);
            *point = nodes.positions[node];
            deforming.predicted_net[control] = deforming.deformable.predicted[node];
        }
        solver.net_changed();
        let (now, then) = (
            box_of(surface.net().points()),
            box_of(&deforming.predicted_net),
        );
        *bounds = (now.0.inf(&then.0), now.1.sup(&then.1));
    }

    fn forget(&self, scratch: &mut BodyScratch) {
        if let Some(deforming) = &mut scratch.deforming {
            self.kind.deformable.forget(&mut deforming.deformable);
        }
    }

    fn respond(&self, _: &BodyState, scratch: &BodyScratch, problem: &mut Problem<'_>) {
        let Problem { rows, solver } = problem;
        let Solver {
            matrix, delassus, ..
        } = &mut **solver;
        let Some(compliance) = self.compliance(scratch) else {
            return;
        };
        self.gather(rows, delassus, |row| {
            directions(&row.normal, row.law.acts_across())
        });
        delassus.each_pair(&compliance, |pair| {
            let [i, j] = pair.rows;
            matrix.add_moved(i, (j, pair.direction), &pair.moved);
        });
    }

    fn take_back(
        &self,
        _: &BodyState,
        scratch: &mut BodyScratch,
        rows: &mut RowSet,
        solver: &mut Solver,
    ) {
        let Some(deforming) = &mut scratch.deforming else {
            return;
        };
        let delassus = &mut solver.delassus;
        self.gather(rows, delassus, |_| empty());
        if delassus.is_empty() {
            return;
        }
        let deformable = &self.kind.deformable;
        deformable.find_rigid_part(&mut deforming.deformable);
        let Some(compliance) = self.compliance(scratch) else {
            return;
        };
        let carried = deformable.carried(compliance.scratch).iter();
        let loads = carried.filter_map(|&(coordinate, force)| {
            Some((deformable.surface_place(coordinate as usize)?, force))
        });
        delassus.each_moved(&compliance, loads, |i, moved| {
            rows.rows[i].take_back(&moved)
        });
    }

    fn gives(
        &self,
        _: &BodyState,
        scratch: &BodyScratch,
        row: &Row,
        problem: &mut Problem<'_>,
    ) -> f64 {
        let Problem { rows, solver } = problem;
        let Some(compliance) = self.compliance(scratch) else {
            return 0.0;
        };
        let delassus = &mut solver.delassus;
        delassus.clear();
        self.add_sides(rows, (0, row), once(row.normal), delassus);
        delassus.sort();
        let mut sum = 0.0;
        delassus.each_pair(&compliance, |pair| {
            sum += 2.0 * pair.moved.dot(&row.normal);
        });
        sum
    }

    fn sweeps(&self, _: usize, _: &dyn Fn() -> bool) -> usize {
        self.kind.sweeps
    }

    fn iterations(&self) -> usize {
        self.kind.deformable.iterations()
    }

    fn take(
        &self,
        scratch: &mut BodyScratch,
        rows: &RowSet,
        row: &Row,
        push_n: Vector3,
        iteration: usize,
    ) {
        let deformable = &self.kind.deformable;
        let Some(deforming) = &mut scratch.deforming else {
            return;
        };
        if deformable.iterations() <= iteration {
            return;
        }
        if row.tool().is_some() {
            deformable.handle(&mut deforming.deformable);
        }
        for (sign, range) in row.sides_on(self.index) {
            let (controls, weights) = rows.weights_in(range);
            for (&control, &weight) in controls.iter().zip(weights) {
                let node = deformable.coordinate_of_control(control as usize);
                deformable.push(&mut deforming.deformable, node, push_n * sign * weight);
            }
        }
    }

    fn correct(&self, state: &BodyState, scratch: &mut BodyScratch, rows: &mut RowSet) {
        let (Some(nodes), Some(deforming)) = (&state.deformable, &mut scratch.deforming) else {
            return;
        };
        let deformable = &self.kind.deformable;
        deformable.iterate(nodes, &mut deforming.deformable);
        for (control, point) in deforming.predicted_net.iter_mut().enumerate() {
            let next = deforming.deformable.predicted[deformable.coordinate_of_control(control)];
            deforming.change[control] = next - *point;
            *point = next;
        }
        rows.shift(self.index, &deforming.change);
    }

    fn arrive(&self, state: &BodyState, scratch: &mut BodyScratch) -> f64 {
        let (Some(nodes), Some(deforming)) = (&state.deformable, &mut scratch.deforming) else {
            return 1.0;
        };
        if self.kind.every > 1 {
            return 1.0;
        }
        let deformable = &self.kind.deformable;
        deformable.arrive(nodes, &mut deforming.deformable);
        deformable.share(&deforming.deformable)
    }

    fn check_arrival(&self, scratch: &BodyScratch, rows: &RowSet, solver: &mut Solver) {
        let Some(compliance) = self.compliance(scratch) else {
            return;
        };
        let (deformable, scratch) = (compliance.deformable, compliance.scratch);
        let Some(went) = deformable.went(scratch).filter(|_| self.kind.every == 1) else {
            return;
        };
        let delassus = &mut solver.delassus;
        self.gather(rows, delassus, |_| empty());
        let loads = deformable
            .carried(scratch)
            .iter()
            .filter_map(|&(coordinate, force)| {
                Some((deformable.surface_place(coordinate as usize)?, force))
            });
        delassus.each_moved(&compliance, loads, |i, moved| {
            let row = &rows.rows[i];
            let (mut found, mut size) = (Vector3::zeros(), 0.0);
            for (sign, side) in row.sides_on(self.index) {
                let (controls, weights) = rows.weights_in(side);
                for (&control, &weight) in controls.iter().zip(weights) {
                    let moved = went(deformable.coordinate_of_control(control as usize));
                    found += moved * (sign * weight);
                    size += moved.norm() * weight.abs();
                }
            }
            // Of two bodies each has moved the row.
            let alone = row.tool().is_some();
            let off = (moved - row.forced - found).norm();
            // Forces that cancel leave their rounding.
            let least = 1e-8 * self.body.size_m;
            // A solve in single precision, by the condition of nearly incompressible bodies.
            let most = 1e-3 * (size + moved.norm() + row.forced.norm()) + least;
            debug_assert!(
                !alone || off <= most || off.is_nan(),
                "row {i}: forces move the body {:?} m, not {:?}",
                moved - row.forced,
                found
            );
        });
    }

    fn side_at(&self, scratch: &BodyScratch, rows: &RowSet, side: Range) -> Option<Point3> {
        let (deformable, deforming) = (&self.kind.deformable, scratch.deforming.as_ref()?);
        if !deformable.has_arrived(&deforming.deformable) {
            return None;
        }
        let (controls, weights) = rows.weights_in(side);
        let mut at = Vector3::zeros();
        for (&control, &weight) in controls.iter().zip(weights) {
            let coordinate = deformable.coordinate_of_control(control as usize);
            at += deformable.reached(&deforming.deformable, coordinate).coords * weight;
        }
        Some(Point3::from(at))
    }

    fn miss(
        &self,
        state: &BodyState,
        scratch: &mut BodyScratch,
        rows: &RowSet,
        solver: &mut Solver,
        turned: &[Vector3],
        off: &mut [Vector3],
    ) {
        let deformable = &self.kind.deformable;
        let (Some(nodes), Some(deforming)) = (&state.deformable, &mut scratch.deforming) else {
            return;
        };
        if self.kind.every > 1 || !deformable.miss(nodes, &mut deforming.deformable) {
            return;
        }
        for (row, turned) in rows.rows.iter().zip(turned) {
            if *turned == Vector3::zeros() {
                continue;
            }
            for (sign, side) in row.sides_on(self.index) {
                let (controls, weights) = rows.weights_in(side);
                for (&control, &weight) in controls.iter().zip(weights) {
                    let coordinate = deformable.coordinate_of_control(control as usize);
                    if deformable.surface_place(coordinate).is_some() {
                        let load = turned * (sign * weight);
                        deformable.add_missed(&mut deforming.deformable, coordinate, &load);
                    }
                }
            }
        }
        let delassus = &mut solver.delassus;
        self.gather(rows, delassus, |_| empty());
        let Some(compliance) = self.compliance(scratch) else {
            return;
        };
        let loads = deformable.missed(compliance.scratch).iter();
        let loads = loads.map(|&(place, load)| (place as usize, load));
        delassus.each_moved(&compliance, loads, |i, moved| off[i] += moved);
    }

    fn shorten(&self, state: &BodyState, scratch: &mut BodyScratch, share: f64) {
        if let (Some(nodes), Some(deforming)) = (&state.deformable, &mut scratch.deforming) {
            let deformable = &self.kind.deformable;
            deformable.shorten(nodes, &mut deforming.deformable, share);
        }
    }

    /// A body that steps once in several ticks begins with the forces of one tick and takes the step over some ticks
    /// later, on whatever thread it was done. In between the surface stands still and answers with its compliance.
    fn hand_over(
        &self,
        around: &Around<'_>,
        state: &mut BodyState,
        scratch: &mut BodyScratch,
        pipeline: &mut Option<Box<dyn Pipeline>>,
    ) {
        if let Some(deforming) = &mut scratch.deforming
            && self.kind.every > 1
        {
            deforming.stepped = self.step(around.field, state, deforming, pipeline);
        }
    }

    fn apply(
        &self,
        _: &Around<'_>,
        state: &mut BodyState,
        scratch: &mut BodyScratch,
    ) -> Option<TickFault> {
        let deforming = scratch.deforming.as_mut()?;
        let nodes = state.deformable.as_mut()?;
        let deformable = &self.kind.deformable;
        match deforming.stepped {
            Stepped::Not => {
                state.moved_m = 0.0;
                return None;
            }
            Stepped::Here => deformable.advance(nodes, &mut deforming.deformable),
            Stepped::Elsewhere => {}
        }
        // A sum is finite only if every part is.
        let sum: f64 = nodes.positions.iter().map(|p| p.x + p.y + p.z).sum();
        let mut fault = (!sum.is_finite()).then_some(TickFault::NotFinite);
        if fault.is_some() {
            deformable.set_to_rest(nodes);
        }
        let (mut moved_squared, reach) = self.moved(nodes, scratch);
        let most_m = TickFault::MOST_SPEED_M_S * deformable.dt_s();
        let apart =
            moved_squared > most_m * most_m || reach > TickFault::MOST_STRETCHED * self.body.size_m;
        if fault.is_none() && apart {
            let body = self.index as u32;
            fault = Some(TickFault::CameApart { body });
            deformable.set_to_rest(nodes);
            moved_squared = self.moved(nodes, scratch).0;
        }
        state.moved_m = moved_squared.sqrt();
        if moved_squared > 0.0 {
            state.revision += 1;
        }
        fault
    }

    /// Has a matrix made elsewhere where the body's cannot follow it any more, and takes over one that is due.
    fn follow(
        &self,
        state: &mut BodyState,
        scratch: &mut BodyScratch,
        pipeline: &mut Option<Box<dyn Pipeline>>,
    ) {
        let (Some(nodes), Some(deforming)) = (&mut state.deformable, &mut scratch.deforming) else {
            return;
        };
        if deforming.stepped == Stepped::Not {
            return;
        }
        let (deformable, scratch) = (&self.kind.deformable, &mut deforming.deformable);
        if deformable.follows(scratch) == Follows::Begun
            && let Some(pipeline) = pipeline
        {
            pipeline.make(self.index, nodes);
        }
        if nodes.following.is_due() {
            let old = deformable.let_go(scratch);
            let made = (pipeline.as_mut()).and_then(|pipeline| pipeline.made(self.index, old));
            deformable.take_over(nodes, scratch, made);
        }
    }

    fn look_ahead(&self, around: &Around<'_>, state: &BodyState, scratch: &mut BodyScratch) {
        let Some(deforming) = &scratch.deforming else {
            return;
        };
        if deforming.stepped != Stepped::Not {
            let predicted = deforming.stepped == Stepped::Elsewhere && scratch.fault.is_none();
            self.prepare(around.field, state, scratch, predicted);
        }
    }

    fn stand_still(&self, field: Field, state: &BodyState, scratch: &mut BodyScratch) {
        let deformable = &self.kind.deformable;
        let Some(deforming) = &mut scratch.deforming else {
            return;
        };
        deformable.drop_loads(&mut deforming.deformable);
        // Takes back where the forces of this tick led: the next one begins with those of the state.
        let arrived = deformable.has_arrived(&deforming.deformable);
        if arrived || deformable.iterations() > 1 {
            self.prepare(field, state, scratch, false);
        }
    }

    fn may_rest(&self) -> bool {
        self.kind.every == 1
    }

    fn leave_alone(
        &self,
        around: &Around<'_>,
        state: &mut BodyState,
        scratch: &mut BodyScratch,
        leave: bool,
    ) {
        if let Some(nodes) = &mut state.deformable {
            nodes.leave_alone(leave);
        }
        self.prepare(around.field, state, scratch, false);
    }

    fn resolution(&self) -> &[Resolution] {
        &self.kind.resolution
    }

    fn net(&self, state: &BodyState, out: &mut [Point3]) {
        let Some(nodes) = &state.deformable else {
            return;
        };
        for (control, point) in out.iter_mut().enumerate() {
            *point = nodes.positions[self.kind.deformable.coordinate_of_control(control)];
        }
    }

    fn speed_m_s(&self, state: &BodyState) -> f64 {
        let velocities = state.deformable.iter().flat_map(|nodes| &nodes.velocities);
        velocities
            .fold(0.0, |most: f64, v| most.max(v.norm_squared()))
            .sqrt()
    }

    fn is_degraded(&self, level: u8, scratch: &BodyScratch) -> bool {
        let fewer = level >= quality::ONE_ITERATION && self.kind.deformable.iterations() > 1;
        let acts = self.fall_back(scratch);
        fewer || acts.is_some_and(|fall_back| fall_back != FallBack::Halved)
    }

    fn begun(&self, state: &BodyState, scratch: &BodyScratch) -> Option<Begun> {
        let deformable = &self.kind.deformable;
        let fall_back = self.fall_back(scratch);
        Some(Begun {
            before: state.deformable.clone()?,
            field: deformable.field(&scratch.deforming.as_ref()?.deformable),
            matrix: match fall_back {
                Some(FallBack::Firmer) => Some("firmer"),
                Some(FallBack::Bounding) => Some("bounding"),
                _ => deformable.step_matrix(),
            },
            fall_back,
        })
    }

    fn balance(&self, begun: &Begun, state: &BodyState, moved: bool) -> Option<Ended> {
        let norm =
            |forces: &[Vector3]| forces.iter().map(Vector3::norm_squared).sum::<f64>().sqrt();
        let after = state.deformable.as_ref()?;
        // Of several ticks a step, the last ends it.
        let ends = moved && state.phase == 0;
        let residual = || (self.kind.deformable).residual(&begun.before, after, begun.field);
        let residual = if ends { residual() } else { None };
        let energy = || (self.kind.deformable).ledger(&begun.before, after, begun.field);
        Some(Ended {
            energy: if ends { energy() } else { None },
            residual_n: residual.map(|forces| norm(&forces)),
            contact_n: norm(&after.contact_n),
        })
    }

    fn is_late(&self, state: &BodyState, pipeline: &mut dyn Pipeline) -> bool {
        if (state.deformable.as_ref()).is_some_and(|nodes| nodes.following.is_nearly_due()) {
            return !pipeline.is_made(self.index);
        }
        // A step begins in one tick and is taken over in a later one: both may have to wait.
        let due = state.phase == 0 || state.phase + 1 >= self.kind.every;
        self.kind.every > 1 && due && !state.put_off && !pipeline.is_ready(self.index)
    }
}

impl Of<'_, &DeformingBody> {
    fn fall_back(&self, scratch: &BodyScratch) -> Option<FallBack> {
        let deforming = scratch.deforming.as_ref()?;
        self.kind.deformable.fall_back(&deforming.deformable)
    }

    /// The body as what its rows do to each other sees it.
    fn compliance<'s>(&self, scratch: &'s BodyScratch) -> Option<Answers<'s>>
    where
        Self: 's,
    {
        let scratch = &scratch.deforming.as_ref()?.deformable;
        Some(Answers {
            deformable: &self.kind.deformable,
            scratch,
        })
    }

    /// All sides of rows on the body, each pushed in some directions.
    fn gather<D: Iterator<Item = Vector3> + Clone>(
        &self,
        rows: &RowSet,
        delassus: &mut Delassus,
        pushed: impl Fn(&Row) -> D,
    ) {
        delassus.clear();
        for (i, row) in rows.rows.iter().enumerate() {
            self.add_sides(rows, (i, row), pushed(row), delassus);
        }
        delassus.sort();
    }

    fn add_sides(
        &self,
        rows: &RowSet,
        (i, row): (usize, &Row),
        pushed: impl Iterator<Item = Vector3> + Clone,
        delassus: &mut Delassus,
    ) {
        let deformable = &self.kind.deformable;
        for (sign, side) in row.sides_on(self.index) {
            let (controls, weights) = rows.weights_in(side);
            let moving = controls.iter().zip(weights);
            let moving = moving.filter_map(|(&control, &weight)| {
                let coordinate = deformable.coordinate_of_control(control as usize);
                Some((deformable.surface_place(coordinate)?, weight))
            });
            delassus.add(i, sign, pushed.clone(), moving);
        }
    }

    /// Of the control points: the square of how far the farthest has moved, m², and the diagonal of their
    /// box, m.
    fn moved(&self, state: &DeformableState, scratch: &BodyScratch) -> (f64, f64) {
        let mut most: f64 = 0.0;
        let (mut low, mut high) = (Point3::from([f64::MAX; 3]), Point3::from([f64::MIN; 3]));
        for (control, old) in scratch.skin.points().iter().enumerate() {
            let now = &state.positions[self.kind.deformable.coordinate_of_control(control)];
            let step = (now - old).norm_squared();
            most = if step > most { step } else { most };
            (low, high) = (low.inf(now), high.sup(now));
        }
        (most, (high - low).norm())
    }

    fn step(
        &self,
        field: Field,
        state: &mut BodyState,
        deforming: &mut DeformingScratch,
        pipeline: &mut Option<Box<dyn Pipeline>>,
    ) -> Stepped {
        let (deformable, scratch) = (&self.kind.deformable, &mut deforming.deformable);
        let Some(nodes) = &mut state.deformable else {
            return Stepped::Not;
        };
        if std::mem::take(&mut state.put_off) {
            deformable.drop_loads(scratch);
            return Stepped::Not;
        }
        if state.phase == 0 {
            deformable.take_loads(scratch, &mut state.loads);
            if let Some(pipeline) = pipeline {
                pipeline.start(self.index, field, nodes, &scratch.predicted, &state.loads);
            }
        } else {
            deformable.drop_loads(scratch);
        }
        state.phase += 1;
        if state.phase < self.kind.every {
            return Stepped::Not;
        }
        state.phase = 0;
        let finished = pipeline
            .as_mut()
            .is_some_and(|pipeline| pipeline.finish(self.index, nodes, &mut scratch.predicted));
        if finished {
            return Stepped::Elsewhere;
        }
        deformable.give_loads(scratch, &state.loads);
        Stepped::Here
    }
}
