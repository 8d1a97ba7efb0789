//! Times of ROS messages.

use serde::Deserialize;
use serde::de::{Deserializer, Error, MapAccess, Visitor, value::MapAccessDeserializer};

/// Seconds.
#[derive(Clone, Copy)]
pub(super) struct Seconds(pub f64);

impl<'de> Deserialize<'de> for Seconds {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Time;
        #[derive(Deserialize)]
        struct Parts {
            #[serde(alias = "secs")]
            sec: i64,
            #[serde(alias = "nsecs", alias = "nsec", default)]
            nanosec: i64,
        }
        impl<'de> Visitor<'de> for Time {
            type Value = Seconds;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a number of seconds, {sec, nanosec} or {secs, nsecs}")
            }

            fn visit_f64<E: Error>(self, value: f64) -> Result<Seconds, E> {
                Ok(Seconds(value))
            }

            fn visit_i64<E: Error>(self, value: i64) -> Result<Seconds, E> {
                Ok(Seconds(value as f64))
            }

            fn visit_u64<E: Error>(self, value: u64) -> Result<Seconds, E> {
                Ok(Seconds(value as f64))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Seconds, A::Error> {
                let parts = Parts::deserialize(MapAccessDeserializer::new(map))?;
                Ok(Seconds(parts.sec as f64 + parts.nanosec as f64 * 1e-9))
            }
        }
        deserializer.deserialize_any(Time)
    }
}
