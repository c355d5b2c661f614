//! TV-L1: an L1 data term, robust to outliers, with total variation, which allows flow discontinuities.

mod explain;

use crate::base::Threads;
use crate::methods::{
    differential::{Advice, Linear},
    variational::{Dual, Explanation, Model, Probe, Settings, Warp, primal_dual},
};
use crate::run::{Guarantee, Info};
use crate::scene::{Case, Name, Question, Reply, Step};
use crate::{params, pseudocode};
use explain::case;

params! {
    /// TV-L1, which minimises the energy ∫∫ λ |I_x u + I_y v + I_t| + |∇u| + |∇v|. Neither term is squared, so outliers of the
    /// gradient constraint and flow discontinuities are penalised only linearly.
    pub struct TvL1 {
        /// Weight λ of the data term (attachment). Smaller values give smoother flow. For gray levels 0 to 255; the paper's values for 0 to 1 are 255 times as large.
        lambda: f32 = 0.2, 0.001..=10.0;
        /// Coupling θ (tightness) between the flow and the auxiliary flow of the data term. Smaller values couple them more tightly but converge more slowly.
        theta: f32 = 0.3, 0.01..=2.0;
        /// Step size τ of the dual update. Convergence is proven up to 0.125; in practice 0.25 converges too, and faster.
        tau: f32 = 0.25, 0.01..=0.25;
        /// Parameters that all variational methods share.
        settings: Settings = Settings { iterations: 40, levels: 5, warps: 5, sigma: 0.0, ..Settings::default() };
    }
    advanced { "tau" }
}

pseudocode! {
    ENERGY: "E(u, v) = ∫∫ λ |ρ| + |∇u| + |∇v|, where ρ = I_x u + I_y v + I_t",
    EACH_LEVEL: "(u, v) ← 0; for each pyramid level, from the coarsest to full resolution; p ← 0",
    EACH_WARP: "  for each warp",
    TAKE_MEDIANS: "    (u₀, v₀) ← 3×3 median filter of (u, v); not before the very first warp",
    WARP: "    warp frame t+1 toward frame t by (u₀, v₀); I_x, I_y, I_t ← derivatives; c ← I_t − I_x u₀ − I_y v₀",
    EACH_ITERATION: "    for each iteration",
    FIT_DATA: "      f = (u_f, v_f) ← (u, v) − s ∇I, s = ρ / |∇I|² clipped to ±λ θ, ρ = I_x u + I_y v + c",
    SMOOTH: "      (u, v) ← (u_f, v_f) + θ (div p_u, div p_v)",
    UPDATE_DUAL: "      p_u ← (p_u + τ/θ ∇u) / (1 + τ/θ |∇u|), p_v ← (p_v + τ/θ ∇v) / (1 + τ/θ |∇v|)",
}

impl Model for TvL1 {
    const INFO: Info = Info {
        id: "tv-l1",
        name: "TV-L1",
        family: "Optical flow",
        summary: "Dense optical flow with an L1 data term, robust to occlusions, and total variation, which keeps motion boundaries sharp.",
        source: "C. Zach, T. Pock and H. Bischof, A duality based approach for realtime TV-L1 optical flow, DAGM 2007; \
                 J. Sánchez, E. Meinhardt-Llopis and G. Facciolo, TV-L1 optical flow estimation, Image Processing On Line 3, \
                 2013; medians: D. Sun, S. Roth and M. J. Black, Secrets of optical flow estimation and their principles, \
                 CVPR 2010",
        pseudocode: line::ALL,
        granularities: &["frame", "level", "warp", "iteration", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[Question::choice(
        "thresholding",
        "How far toward the constraint line does thresholding move the auxiliary flow?",
        &[
            Reply::told(line::FIT_DATA, case::MOVES, "All the way"),
            Reply::told(line::FIT_DATA, case::CLIPPED, "Part of the way: the step is clipped"),
            Reply::told(line::FIT_DATA, case::UNKNOWN, "Not at all: there is no constraint"),
        ],
    )];
    const GUARANTEE: Guarantee = Guarantee::SubPixel { off_centi_px: 5 };
    const ENERGY_UNIT: &'static str = "px";
    const OPENING: &'static Case = case::OPENING;
    const ADVICE: Advice =
        Advice { texture: case::ADVISE_TEXTURE, boundary: case::ADVISE_BOUNDARY, motion: case::ADVISE_MOTION };
    const SYSTEM_PARTS: usize = 0;
    const NEED: [f64; 2] = [122.0, 275.0];
    type System = ();
    type Unknowns = Dual;

    fn settings(&self) -> Settings {
        self.settings
    }

    fn steps(&self) -> &'static [Name] {
        &[line::FIT_DATA, line::SMOOTH, line::UPDATE_DUAL]
    }

    fn system(&self, _: &Linear, _: &Threads) {}

    fn iterate(&self, warp: &Warp<Self>, from: &Dual, count: usize, threads: &Threads) -> Dual {
        let mut unknowns = from.clone();
        unknowns.iterate(&warp.linear, self.weights(), count, threads);
        unknowns
    }

    fn energy(&self, warp: &Warp<Self>, at: &Dual) -> [f64; 2] {
        primal_dual::energy(&warp.linear, self.lambda, &at.field)
    }

    fn explanation(&self, index: usize, probe: &Probe<Self>, step: Step) -> Explanation {
        explain::explanation(self, index, probe, step)
    }
}

impl TvL1 {
    fn weights(&self) -> primal_dual::Weights {
        primal_dual::Weights { most: self.lambda * self.theta, theta: self.theta, rate: self.tau / self.theta }
    }
}
