//! The table of all tallies.

/// All tallies, handed to the macro `$to`: fields of the summary, each with its description, its name, its type, and
/// what counts it.
macro_rules! table {
    ($to:ident) => {
        $to! {
            /// One number a trace: its distribution over the traces.
            scalars: Vec<tally::Scalar> = tally::scalars::Scalars;
            /// Histograms of the rope length at the end and of the greatest.
            histograms: Vec<tally::Histogram> = tally::histograms::Histograms;
            /// For each limit, when the rope became longer.
            survival: Vec<tally::Survival> = tally::survival::Limits;
            /// How the tether held the walks back; `None` without one.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            tether: Option<tally::TetherAnswer> = tally::tether::HeldBack;
            /// The obstacles that ropes were wound about at the end, the most often first.
            obstacles: Vec<tally::Obstacle> = tally::obstacles::Obstacles;
            /// The most common taut ropes at the end, the most common first.
            ropes: Vec<tally::CommonRope> = tally::ropes::Ropes;
            /// The homotopy classes of ropes at the end, if the study asks for them.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            classes: Option<tally::ClassAnswer> = tally::classes::Classes;
            /// The wall ends with which ropes had contacts, those with the greatest share of steps first, at most a
            /// thousand.
            contacts: Vec<tally::Contact> = tally::contacts::Contacts;
            /// What the ropes of each anchor say, in the order of the anchors; `None` unless `study.tallies.anchors`
            /// asks for it.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            anchors: Option<Vec<tally::AnchorAnswer>> = tally::anchors::Anchors;
            /// Contacts and turns counted by obstacle, if the study asks for that.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            by_obstacle: Option<tally::ByObstacle> = tally::by_obstacle::Obstacles;
            /// What friction makes of the tension in ropes; `None` unless `study.tallies.friction` asks for it.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            friction: Option<tally::FrictionAnswer> = tally::friction::Tensions;
            /// The plane.
            map: Option<tally::Map> = tally::map::Cells;
        }
    };
}
pub(crate) use table;
