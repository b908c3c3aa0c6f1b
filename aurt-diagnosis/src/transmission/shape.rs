use super::link::Gear;

/// A gear as it is searched for: by the frequency of its link rather than by its stiffness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shape {
    /// √(K/M̄)/2π with the mean M̄ of the link's inertia.
    pub hz: f64,
    /// Damping ratio.
    pub ratio: f64,
    /// Half the play, rad.
    pub half_gap_rad: f64,
    /// Share of the least M_jj that is the rotor's: where a motion cannot tell a rotor from the link (the first joints
    /// of common arms), a fit puts both into the link.
    pub rotor_share: f64,
}

/// Inertia about a joint along its motion, M_jj.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Inertia {
    pub mean_kg_m2: f64,
    pub least_kg_m2: f64,
}

/// Distance of the starts in frequency.
const STEP: f64 = 1.15;
/// Damping ratios of the starts. A gear of less damping than the first rings within its peak, one of more has no peak.
const RATIOS: [f64; 2] = [0.06, 0.2];
/// Lowest frequency of a resonance that is looked for, Hz: below, a robot's gear would be softer than its servo.
const LOWEST_HZ: f64 = 1.5;
/// Highest, in units of the highest frequency of the rows.
const HIGHEST: f64 = 0.9;
/// Smallest half play that is tried, rad: a third of an arc minute; each further one is twice as wide.
const LEAST_GAP_RAD: f64 = 1e-4;
const GAPS: u32 = 9;
/// Frequencies of links on the flanks of a gear with play, Hz, and damping ratios: flanks are as stiff as a data sheet's gear. The
/// frequencies lie above the rows, in which an impact is a jolt of about this length. From softer flanks of less damping a link parts with
/// half of the speed with which it strikes, exp(−πζ/√(1 − ζ²)), from the others with a tenth.
const FLANKS: [[f64; 2]; 2] = [[15.0, 0.2], [40.0, 0.6]];
/// Highest frequency on flanks, Hz: twice that of the stiffer start. An impact is over in 6 ms, and rows below 12 Hz tell no shorter ones apart.
const STIFFEST_FLANK_HZ: f64 = 80.0;
/// Bounds of the damping ratio: of more there is no resonance, and the torque is that of a low-pass …
const RATIO_RANGE: [f64; 2] = [0.003, 0.45];
/// … and from flanks of more a link parts with less than 0.15 % of the speed with which it strikes.
const MOST_OF_FLANKS: f64 = 0.9;

/// Frequencies within this factor of the ends of the range are at the end: half a step between starts.
const END: f64 = 1.07;

/// Largest share of the least M_jj that is a rotor's.
const MOST_ROTOR: f64 = 0.9;

impl Shape {
    /// Starts for elastic gears.
    pub fn elastic(top_hz: f64) -> Vec<Self> {
        let steps = ((HIGHEST * top_hz / LOWEST_HZ).ln() / STEP.ln()).max(0.0) as i32;
        (0..=steps)
            .flat_map(|k| {
                let hz = LOWEST_HZ * STEP.powi(k);
                RATIOS.map(|ratio| Self { hz, ratio, half_gap_rad: 0.0, rotor_share: 0.0 })
            })
            .collect()
    }

    /// Starts for gears with play.
    pub fn with_play() -> Vec<Self> {
        (0..GAPS)
            .flat_map(|k| {
                let half_gap_rad = LEAST_GAP_RAD * f64::from(2_u32.pow(k));
                FLANKS.map(|[hz, ratio]| Self { hz, ratio, half_gap_rad, rotor_share: 0.0 })
            })
            .collect()
    }

    /// The gear of a joint.
    pub fn gear(self, inertia: Inertia) -> Gear {
        let omega = std::f64::consts::TAU * self.hz;
        let rotor_kg_m2 = self.rotor_share * inertia.least_kg_m2.max(0.0);
        let inertia_kg_m2 = inertia.mean_kg_m2 - rotor_kg_m2;
        Gear {
            stiffness_nm_rad: inertia_kg_m2 * omega * omega,
            damping_nm_s: 2.0 * self.ratio * inertia_kg_m2 * omega,
            half_gap_rad: self.half_gap_rad,
            rotor_kg_m2,
        }
    }

    /// The shape with one of its freedoms moved: the logarithms of 0 frequency and 1 damping ratio, 2 the rotor's share, 3 the
    /// logarithm of the play.
    pub fn moved(self, which: usize, by: f64, top_hz: f64) -> Self {
        let mut moved = self;
        match which {
            0 => {
                let highest = if self.half_gap_rad > 0.0 { STIFFEST_FLANK_HZ } else { HIGHEST * top_hz };
                moved.hz = (moved.hz * by.exp()).clamp(LOWEST_HZ, highest.max(LOWEST_HZ));
            }
            1 => {
                let most = if self.half_gap_rad > 0.0 { MOST_OF_FLANKS } else { RATIO_RANGE[1] };
                moved.ratio = (moved.ratio * by.exp()).clamp(RATIO_RANGE[0], most);
            }
            2 => moved.rotor_share = (moved.rotor_share + by).clamp(0.0, MOST_ROTOR),
            _ => moved.half_gap_rad *= by.exp(),
        }
        moved
    }

    /// Sameness but for what a pattern search finds by itself, which is all but the flanks of play.
    pub fn is_of_a_kind(self, other: Self) -> bool {
        self.half_gap_rad == 0.0 || [self.hz, self.ratio] == [other.hz, other.ratio]
    }

    /// Whether an elastic gear's frequency stands at the end of the range that is looked at: there is no resonance in it.
    pub fn is_at_the_end(self, top_hz: f64) -> bool {
        self.half_gap_rad == 0.0 && !(LOWEST_HZ * END..HIGHEST * top_hz / END).contains(&self.hz)
    }

    /// Number of freedoms.
    pub fn freedoms(self) -> usize {
        if self.half_gap_rad > 0.0 { 4 } else { 3 }
    }
}
