//! The options of all tallies, as a plan has them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

macro_rules! options {
    (options { $($(#[$doc:meta])* $name:ident: $Type:ty = $usual:expr;)* } tallies { $($_:tt)* }) => {
        /// What is counted.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields, default)]
        pub struct TallyPlan {
            $($(#[$doc])* pub $name: $Type,)*
        }

        impl Default for TallyPlan {
            fn default() -> Self {
                TallyPlan { $($name: $usual,)* }
            }
        }
    };
}

super::table!(options);
