//! The Kalman filter against recorded results of others, and against its own promises.

use motionscope_core::methods::kalman::{
    Acceleration, Estimate, Filter, Innovation, Measurement, Model, Motion, Nonlinear, Sensor, Turn, Velocity,
    chi_square,
};
use nalgebra::{Matrix2, SMatrix, SVector, Vector2, Vector4};

/// Places measured frame by frame; one is missing.
const PLACES: [Option<[f64; 2]>; 6] =
    [Some([12.0, 7.0]), Some([14.5, 6.25]), None, Some([19.0, 5.5]), Some([22.25, 3.75]), Some([24.0, 4.0])];

fn measured(place: [f64; 2]) -> Measurement {
    Measurement { place, place_deviation: 1.5, velocity: None }
}

/// What is believed after each of [`PLACES`], and the squared distances of those.
fn followed(model: Model) -> Vec<(Filter, Option<f64>)> {
    let mut filter = Filter::begun(model, &measured([10.0, 8.0]), 10.0);
    let mut all = Vec::new();
    for place in PLACES {
        filter = filter.predicted();
        let squared = place.map(|place| {
            let (updated, squared) = filter.updated(&measured(place)).expect("sound");
            filter = updated;
            squared
        });
        all.push((filter, squared));
    }
    all
}

fn near(found: &[f64], wanted: &[f64]) {
    let off = found.iter().zip(wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(found.len() == wanted.len() && off < 1e-9, "{found:?} instead of {wanted:?}");
}

/// Entries of a covariance: of x, of x and a further number, and of that.
fn entries(filter: &Filter, other: usize) -> [f64; 3] {
    let covariance = filter.covariance();
    [covariance[(0, 0)], covariance[(other, 0)], covariance[(other, other)]]
}

#[test]
fn constant_velocity_agrees_with_filterpy() {
    // filterpy 1.4.5: KalmanFilter(4, 2), P = diag(1.5², 1.5², 10², 10²), Q = 0.7² G Gᵀ, R = 1.5² I.
    let recorded: [([f64; 4], [f64; 3], Option<f64>); 6] = [
        (
            [11.956988219551244, 7.021505890224378, 1.9163181915935865, -0.9581590957967933],
            [2.201611746995149, 2.155857965542785, 4.43934144185045],
            Some(0.04779086716528471),
        ),
        (
            [14.39418066200638, 6.218482973179698, 2.238018357386786, -0.8623445410505587],
            [1.870079868822997, 1.154990869392754, 1.418066837243823],
            Some(0.03208846879272029),
        ),
        (
            [16.632199019393166, 5.356138432129139, 2.238018357386786, -0.8623445410505587],
            [5.720628444852328, 2.8180577066365773, 1.908066837243823],
            None,
        ),
        (
            [18.98132601519956, 5.355220389926535, 2.2792764481305747, -0.5424701085662759],
            [1.926255073610633, 0.7152783775693051, 0.8177388823808336],
            Some(0.06582297192735743),
        ),
        (
            [21.90997751419235, 4.1152313443968795, 2.5479723808137544, -0.831086834882918],
            [1.4767510634378196, 0.6110444246425097, 0.8248733118871961],
            Some(0.32202983283992165),
        ),
        (
            [24.174754070877732, 3.726828933717859, 2.417418062027465, -0.6270076835849698],
            [1.3913980792163727, 0.6414396432282987, 0.8356700793468697],
            Some(0.12247982935570814),
        ),
    ];
    let found = followed(Model::Velocity(Velocity { acceleration: 0.7 }));
    for ((filter, squared), (state, covariance, recorded)) in found.iter().zip(recorded) {
        near(&filter.state(), &state);
        near(&entries(filter, 2), &covariance);
        near(&squared.iter().copied().collect::<Vec<_>>(), &recorded.into_iter().collect::<Vec<_>>());
    }
}

#[test]
fn smoothing_agrees_with_filterpy() {
    // filterpy 1.4.5: rts_smoother over the same run.
    let recorded: [([f64; 4], [f64; 3]); 6] = [
        (
            [12.160830285164037, 7.115259951600704, 2.3227011747043993, -0.730636609853081],
            [0.7376611986331099, -0.10236870847445845, 0.4736184653446873],
        ),
        (
            [14.50460137513732, 6.4006801049265505, 2.364841005242169, -0.6985230834952256],
            [0.7212969252940427, 0.04574043488917745, 0.3125624643598648],
        ),
        (
            [16.888884278148357, 5.713561305475307, 2.403724800779905, -0.6757145154072631],
            [0.7802792606786548, 8.487663386036459e-05, 0.25993436891356825],
        ),
        (
            [19.31017243988408, 5.036394900375522, 2.438851522691543, -0.678618294792307],
            [0.7213529819695377, -0.04583489791403317, 0.3126393986293461],
        ),
        (
            [21.747821620546926, 4.368709264244856, 2.436446838634151, -0.6567529774690253],
            [0.7374816656054728, 0.10259901105597613, 0.47518111665337126],
        ),
        (
            [24.174754070877732, 3.726828933717859, 2.417418062027465, -0.6270076835849698],
            [1.3913980792163727, 0.6414396432282987, 0.8356700793468697],
        ),
    ];
    let found = followed(Model::Velocity(Velocity { acceleration: 0.7 }));
    let mut next = found[5].0;
    for i in (0..6).rev() {
        if i < 5 {
            next = found[i].0.smoothed(&next).expect("sound");
        }
        near(&next.state(), &recorded[i].0);
        near(&entries(&next, 2), &recorded[i].1);
    }
}

#[test]
fn constant_acceleration_agrees_with_opencv() {
    // OpenCV 5.0.0: cv2.KalmanFilter(6, 2, 0, CV_64F), the acceleration's deviation at first 2, Q = 0.3² G Gᵀ, R = 1.5² I.
    let recorded: [([f64; 6], [f64; 3]); 6] = [
        (
            [
                11.95735506645502,
                7.02132246677249,
                1.9340898860432607,
                -0.9670449430216304,
                0.03875950626643606,
                -0.01937975313321803,
            ],
            [2.2020244497619217, 0.04360444454974122, 4.050368404842569],
        ),
        (
            [
                14.423825425906916,
                6.223442201940987,
                2.408436874759591,
                -0.8345597919703907,
                0.18183843691958246,
                0.03050383849858281,
            ],
            [1.9590971170250082, 0.5464037563126838, 3.1140565929439106],
        ),
        (
            [
                16.9231815191263,
                5.404134329219888,
                2.5902753116791732,
                -0.8040559534718078,
                0.18183843691958246,
                0.03050383849858281,
            ],
            [14.022617429696826, 5.276704315738295, 3.2040565929439104],
        ),
        (
            [
                19.0200103665315,
                5.470709353757582,
                2.3905032874316854,
                -0.21496079667560664,
                0.06394570414581817,
                0.2030721082897373,
            ],
            [2.1755044524834872, 0.4388966919907613, 0.7082603586422529],
        ),
        (
            [
                22.095352059567915,
                4.0578131284150745,
                2.9170326747438557,
                -0.9326208382700973,
                0.2078969752561639,
                -0.08345024031703849,
            ],
            [1.819099626726799, 0.4010959103709477, 0.42490739982664494],
        ),
        (
            [
                24.249326654456414,
                3.7952976228642084,
                2.540699539491804,
                -0.5364059875198461,
                0.04019484633671511,
                0.05423670099851799,
            ],
            [1.7474753402464307, 0.3380082063786245, 0.2875562731469689],
        ),
    ];
    let found = followed(Model::Acceleration(Acceleration { change: 0.3 }));
    for ((filter, _), (state, covariance)) in found.iter().zip(recorded) {
        near(&filter.state(), &state);
        near(&entries(filter, 4), &covariance);
    }
}

#[test]
fn a_turn_agrees_with_an_extended_filter_and_smoother_by_others() {
    // numpy 2.4, written for this from Bar-Shalom, Li and Kirubarajan 2001: deviations of the acceleration 0.3, of the change of
    // rate 0.05, of the rate at first 0.15.
    let recorded: [([f64; 5], [f64; 3], Option<f64>); 6] = [
        (
            [11.956947068812935, 7.021526465593532, 1.9143246669377407, -0.9571623334688704, 0.0],
            [2.2015654524145516, 0.0, 0.025],
            Some(0.047836590207849986),
        ),
        (
            [14.392185844466658, 6.218294680867986, 2.22806371864209, -0.8634131885524642, 0.0009104995732156454],
            [1.8640712500697676, 0.002048624039735202, 0.02744553150649241],
            Some(0.032742867245920224),
        ),
        (
            [16.620642323903798, 5.355895937074195, 2.228848932330256, -0.861384179879007, 0.0009104995732156454],
            [5.3348593879809565, 0.03179413938308271, 0.029945531506492408],
            None,
        ),
        (
            [18.982307576276405, 5.349602003719625, 2.291463565747839, -0.5346636074019784, 0.015023798698188534],
            [1.881581940224033, 0.012730853015707094, 0.02930377261276077],
            Some(0.0683229887754826),
        ),
        (
            [21.853387852099246, 4.134863606622638, 2.448221664718795, -0.7752147527345874, -0.0022231063116882176],
            [1.383150092702824, 0.019327440603960317, 0.027483958276939606],
            Some(0.3564950725716712),
        ),
        (
            [24.16501718447494, 3.7589361246002753, 2.431275964638686, -0.582685275306686, 0.014627722972469904],
            [1.205948588751462, 0.0225120451412183, 0.023077979869980468],
            Some(0.09095538453483674),
        ),
    ];
    let smoothed: [([f64; 5], [f64; 3]); 6] = [
        (
            [12.171144298887047, 7.119937388555319, 2.3514655604241104, -0.7506559221036199, 0.01275950658435472],
            [0.7049060374611129, -0.002251156089174215, 0.01458107439208003],
        ),
        (
            [14.533385210167511, 6.383810186990256, 2.3730162621368174, -0.7215984810265057, 0.01354089709144724],
            [0.548647755131247, -0.01875262218950713, 0.01529736126411843],
        ),
        (
            [16.916634656617262, 5.678518321138573, 2.3934737596940967, -0.6889818472147999, 0.01396614511751076],
            [0.522650324349283, -0.024633476748616025, 0.016495723475016915],
        ),
        (
            [19.319957251111806, 5.00382919948214, 2.4131622646600746, -0.6603928939476531, 0.014371401996208606],
            [0.5465780940251423, -0.019172004159510134, 0.018284820141498105],
        ),
        (
            [21.737986797440257, 4.361947828956853, 2.4228133692401137, -0.6233473488500971, 0.014627722972469904],
            [0.7053233760164288, -0.004136035362099475, 0.020577979869980466],
        ),
        (
            [24.16501718447494, 3.7589361246002753, 2.431275964638686, -0.582685275306686, 0.014627722972469904],
            [1.205948588751462, 0.0225120451412183, 0.023077979869980468],
        ),
    ];
    let found = followed(Model::Turn(Turn { acceleration: 0.3, rate_change: 0.05, prediction: Nonlinear::Extended }));
    for ((filter, squared), (state, covariance, recorded)) in found.iter().zip(recorded) {
        near(&filter.state(), &state);
        near(&entries(filter, 4), &covariance);
        near(&squared.iter().copied().collect::<Vec<_>>(), &recorded.into_iter().collect::<Vec<_>>());
    }
    let mut next = found[5].0;
    for i in (0..6).rev() {
        if i < 5 {
            next = found[i].0.smoothed(&next).expect("sound");
        }
        near(&next.state(), &smoothed[i].0);
        near(&entries(&next, 4), &smoothed[i].1);
    }
}

/// Normally distributed numbers, the same ones each time.
struct Chance(u64);

impl Chance {
    /// Of a mixed seed: streams of neighbours that differ by a multiple of what they begin with would not be independent.
    fn new(seed: u64) -> Self {
        let mix = |x: u64| {
            let x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            let x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            x ^ (x >> 31)
        };
        Self(mix(mix(seed.wrapping_add(0x9E37_79B9_7F4A_7C15))))
    }

    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64 + 0.5) / 9_007_199_254_740_992.0
    }

    fn normal(&mut self) -> f64 {
        (-2.0 * self.unit().ln()).sqrt() * (std::f64::consts::TAU * self.unit()).cos()
    }
}

/// The squared errors (NEES) and squared innovations (NIS) of a filter on objects that move and are measured just as it
/// thinks, at each of `frames`, averaged over `seeds`.
fn consistency<const N: usize>(
    motion: &impl Motion<N>,
    disturb: impl Fn(&mut SVector<f64, N>, &mut Chance),
    (frames, seeds): (usize, u64),
) -> Vec<[f64; 2]> {
    let sensor = Sensor::<N, 2>::first([1.5; 2]);
    let mut sums = vec![[0.0; 2]; frames];
    for seed in 0..seeds {
        let mut chance = Chance::new(seed);
        let deviations = motion.initial_deviations(3.0).map(|deviation| if deviation > 0.0 { deviation } else { 2.0 });
        let covariance = SMatrix::from_diagonal(&SVector::from(deviations).map(|d| d * d));
        let mut estimate = Estimate { state: SVector::zeros(), covariance };
        let mut truth = SVector::from(deviations).map(|deviation| deviation * chance.normal());
        for sum in &mut sums {
            truth = motion.moved(&truth);
            disturb(&mut truth, &mut chance);
            estimate = estimate.predicted(motion).estimate;
            let place = Vector2::new(truth[0] + 1.5 * chance.normal(), truth[1] + 1.5 * chance.normal());
            let innovation = estimate.innovation(&sensor, &place).expect("sound");
            estimate = estimate.updated(&sensor, &innovation).estimate;
            let error = estimate.squared_error(&truth).expect("sound");
            *sum = [sum[0] + error / seeds as f64, sum[1] + innovation.squared_distance / seeds as f64];
        }
    }
    sums
}

/// Whether the means of `seeds` values with `dof` degrees of freedom each lie within what 95 % of such means do, as often as
/// they should: frames are not independent, so nine of ten are well within chance.
fn assert_within(means: impl Iterator<Item = f64>, dof: usize, seeds: usize) {
    let [low, high] = [0.025, 0.975].map(|p| chi_square::quantile(p, dof * seeds) / seeds as f64);
    let all: Vec<f64> = means.collect();
    let inside = all.iter().filter(|mean| (low..high).contains(*mean)).count();
    assert!(10 * inside >= 9 * all.len(), "{inside} of {} within {low}..{high}: {all:?}", all.len());
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    assert!((low..high).contains(&mean), "{mean} is not within {low}..{high}");
}

#[test]
fn the_filter_is_consistent_over_a_hundred_seeds() {
    let (velocity, acceleration) = (Velocity { acceleration: 0.5 }, Acceleration { change: 0.2 });
    let all = consistency(
        &velocity,
        |truth, chance| {
            for i in 0..2 {
                let a = 0.5 * chance.normal();
                truth[i] += 0.5 * a;
                truth[i + 2] += a;
            }
        },
        (40, 100),
    );
    assert_within(all.iter().map(|both| both[0]), 4, 100);
    assert_within(all.iter().map(|both| both[1]), 2, 100);
    let all = consistency(
        &acceleration,
        |truth, chance| {
            for i in 0..2 {
                let a = 0.2 * chance.normal();
                truth[i] += 0.5 * a;
                truth[i + 2] += a;
                truth[i + 4] += a;
            }
        },
        (40, 100),
    );
    assert_within(all.iter().map(|both| both[0]), 6, 100);
    assert_within(all.iter().map(|both| both[1]), 2, 100);
}

#[test]
fn a_linearised_turn_is_consistent_while_it_is_gentle() {
    // The filter begins with what is true but for chance, at 20 px/frame and 4°/frame; where the rate is not known at all an
    // extended filter cannot be consistent.
    let (motion, rate) =
        (Turn { acceleration: 0.1, rate_change: 0.001, prediction: Nonlinear::Extended }, 4.0_f64.to_radians());
    let start = SVector::from([0.0, 0.0, 20.0, 0.0, rate]);
    let deviations = SVector::from([1.5, 1.5, 0.5, 0.5, 0.01]);
    let sensor = Sensor::<5, 2>::first([1.5; 2]);
    let mut means = [[0.0; 2]; 20];
    for seed in 0..100 {
        let mut chance = Chance::new(1000 + seed);
        let covariance = SMatrix::from_diagonal(&deviations.map(|d| d * d));
        let mut estimate = Estimate { state: start, covariance };
        let mut truth = start + deviations.map(|deviation| deviation * chance.normal());
        for mean in &mut means {
            truth = motion.moved(&truth);
            for i in 0..2 {
                let a = 0.1 * chance.normal();
                truth[i] += 0.5 * a;
                truth[i + 2] += a;
            }
            truth[4] += 0.001 * chance.normal();
            estimate = estimate.predicted(&motion).estimate;
            let place = Vector2::new(truth[0] + 1.5 * chance.normal(), truth[1] + 1.5 * chance.normal());
            let innovation = estimate.innovation(&sensor, &place).expect("sound");
            estimate = estimate.updated(&sensor, &innovation).estimate;
            mean[0] += estimate.squared_error(&truth).expect("sound") / 100.0;
            mean[1] += innovation.squared_distance / 100.0;
        }
    }
    assert_within(means.iter().map(|both| both[0]), 5, 100);
    assert_within(means.iter().map(|both| both[1]), 2, 100);
}

#[test]
fn a_turn_is_followed_better_by_a_model_that_knows_turns() {
    let at = |t: f64| [60.0 + 40.0 * (0.2 * t).cos(), 60.0 + 40.0 * (0.2 * t).sin()];
    let error = |model: Model| {
        let mut chance = Chance::new(5);
        let mut filter = Filter::begun(model, &measured(at(0.0)), 10.0);
        let mut sum = 0.0;
        for t in 1..80 {
            let place = at(f64::from(t)).map(|c| c + 1.5 * chance.normal());
            filter = filter.predicted().updated(&measured(place)).expect("sound").0;
            let [x, y] = filter.place();
            let [true_x, true_y] = at(f64::from(t));
            sum += if t > 20 { (x - true_x).hypot(y - true_y) } else { 0.0 };
        }
        sum / 59.0
    };
    let turn = error(Model::Turn(Turn { acceleration: 0.1, rate_change: 0.002, prediction: Nonlinear::Extended }));
    let straight = error(Model::Velocity(Velocity { acceleration: 0.1 }));
    // The measurements themselves are 1.5 √(π/2) = 1.88 px off on average.
    assert!(turn < 1.4 && 3.0 * turn < straight, "{turn} and {straight} px off");
}

#[test]
fn uncertainty_grows_without_measurements_and_shrinks_with_them() {
    let found = followed(Model::Velocity(Velocity { acceleration: 0.7 }));
    let area = |i: usize| {
        let [[a, b], [c, d]] = found[i].0.place_covariance();
        a * d - b * c
    };
    assert!(area(2) > 5.0 * area(1), "frame 2 was not seen");
    assert!(area(3) < area(2) / 5.0);
    let smoothed = found[2].0.smoothed(&found[3].0).expect("sound").place_covariance();
    assert!(smoothed[0][0] < found[2].0.place_covariance()[0][0]);
}

#[test]
fn a_second_sensor_and_a_velocity_make_the_estimate_surer() {
    let model = Model::Velocity(Velocity { acceleration: 0.7 });
    let filter = Filter::begun(model, &measured([0.0; 2]), 10.0).predicted();
    let first = filter.updated(&measured([1.0, 1.0])).expect("sound").0;
    let second = first.updated(&measured([1.5, 0.5])).expect("sound").0;
    let with_velocity = Measurement { velocity: Some(([1.0, 1.0], 0.5)), ..measured([1.5, 0.5]) };
    let third = first.updated(&with_velocity).expect("sound").0;
    let variances = |filter: &Filter| [entries(filter, 2)[0], entries(filter, 2)[2]];
    let [a, b, c] = [first, second, third].map(|filter| variances(&filter));
    assert!(b[0] < a[0] && c[0] < b[0] && b[1] < a[1] && c[1] < b[1] / 4.0, "{a:?} {b:?} {c:?}");
    // Two independent measurements of one place are as one of half the variance.
    let fused = Measurement { place_deviation: 1.5 / 2.0_f64.sqrt(), ..measured([1.25, 0.75]) };
    let both = filter.updated(&fused).expect("sound").0;
    near(&both.state(), &second.state());
}

#[test]
fn a_singular_covariance_is_no_panic() {
    let nothing = Estimate::<4> { state: Vector4::zeros(), covariance: SMatrix::zeros() };
    let exact = Sensor { observation: SMatrix::<f64, 2, 4>::identity(), noise: Matrix2::zeros() };
    let innovation: Option<Innovation<2>> = nothing.innovation(&exact, &Vector2::new(1.0, 2.0));
    assert!(innovation.is_none());
    assert_eq!(nothing.squared_error(&Vector4::zeros()), None);
    let unknown = Measurement { place: [f64::NAN; 2], ..measured([0.0; 2]) };
    let filter = Filter::begun(Model::Velocity(Velocity { acceleration: 1.0 }), &measured([0.0; 2]), 5.0);
    assert!(filter.updated(&unknown).is_none());
}
