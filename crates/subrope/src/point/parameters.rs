//! Parameters of the bundle law in the keys of the JSON form.

use std::fmt;

use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde::ser::{Serialize, Serializer};
use serde_json::Value;
use subrope_material::{BundleParameters, Compaction, Friction, Hardening, ModeParameters};

use super::EntryFault;

/// Parameters by name, in the order of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Params(Vec<(String, Value)>);

impl Params {
    /// The value of a parameter.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&Value> {
        self.0.iter().find(|(k, _)| k == key).map(|(_, value)| value)
    }

    /// The names.
    pub fn keys(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(|(key, _)| key.as_str())
    }
}

impl FromIterator<(String, Value)> for Params {
    fn from_iter<I: IntoIterator<Item = (String, Value)>>(entries: I) -> Self {
        Self(entries.into_iter().collect())
    }
}

impl Serialize for Params {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(key, value)| (key, value)))
    }
}

impl<'de> Deserialize<'de> for Params {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Entries)
    }
}

struct Entries;

impl<'de> Visitor<'de> for Entries {
    type Value = Params;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object of parameters")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Params, A::Error> {
        let mut entries = Vec::new();
        while let Some(entry) = map.next_entry()? {
            entries.push(entry);
        }
        Ok(Params(entries))
    }
}

/// Keys that `params` may hold.
const KEYS: [&str; 24] = [
    "K_e",
    "K_ec",
    "w_e",
    "K_c",
    "nu",
    "comp_type",
    "K_p",
    "p_exp",
    "z_lock",
    "friction",
    "K_t",
    "tau_t0",
    "H_t",
    "mu_t",
    "X_t",
    "H_inf_t",
    "kappa_s_t",
    "K_l",
    "tau_l0",
    "H_l",
    "mu_l",
    "X_l",
    "H_inf_l",
    "kappa_s_l",
];

/// Keys of one mode: modulus, threshold, linear hardening, pressure, kinematic and saturating hardening.
struct ModeKeys([&'static str; 7]);

const TRANSVERSE: ModeKeys = ModeKeys(["K_t", "tau_t0", "H_t", "mu_t", "X_t", "H_inf_t", "kappa_s_t"]);
const LONGITUDINAL: ModeKeys = ModeKeys(["K_l", "tau_l0", "H_l", "mu_l", "X_l", "H_inf_l", "kappa_s_l"]);

/// Parameters of the law, from `params`.
pub(super) fn read(params: &Params) -> Result<BundleParameters, EntryFault> {
    if let Some(key) = params.keys().find(|k| !KEYS.contains(k)) {
        return Err(EntryFault::UnknownParameter { key: key.to_owned(), allowed: &KEYS });
    }
    let friction = optional(params, "friction")?.unwrap_or(1.0) != 0.0;
    Ok(BundleParameters {
        k_e: required(params, "K_e")?,
        k_ec: required(params, "K_ec")?,
        w_e: optional(params, "w_e")?.unwrap_or(0.0),
        k_c: required(params, "K_c")?,
        nu: optional(params, "nu")?.unwrap_or(0.0),
        compaction: compaction(params)?,
        transverse: mode(params, &TRANSVERSE, friction)?,
        longitudinal: mode(params, &LONGITUDINAL, friction)?,
    })
}

fn compaction(params: &Params) -> Result<Compaction, EntryFault> {
    let key = "comp_type";
    let value = optional(params, key)?.unwrap_or(0.0);
    match value {
        0.0 => Ok(Compaction::Quadratic),
        1.0 => Ok(Compaction::Power { k_p: required(params, "K_p")?, m: required(params, "p_exp")? }),
        2.0 => Ok(Compaction::LockUp { z_lock: required(params, "z_lock")? }),
        _ => Err(EntryFault::Parameter { key, value, allowed: "0 (quadratic), 1 (power) or 2 (lock-up)" }),
    }
}

fn mode(params: &Params, keys: &ModeKeys, slides: bool) -> Result<ModeParameters, EntryFault> {
    let [k, tau, h, mu, x, h_inf, kappa_s] = keys.0;
    let k = required(params, k)?;
    if !slides {
        return Ok(ModeParameters::elastic(k));
    }
    let linear = optional(params, h)?.unwrap_or(0.0);
    let hardening = match optional(params, h_inf)?.filter(|limit| *limit != 0.0) {
        None => Hardening::Linear { h: linear },
        Some(_) if linear != 0.0 => {
            return Err(EntryFault::Parameter { key: h, value: linear, allowed: "0 where H_inf is given" });
        }
        Some(limit) => Hardening::Saturating { h_inf: limit, kappa_s: required(params, kappa_s)? },
    };
    let (tau, x, mu) = (required(params, tau)?, optional(params, x)?, optional(params, mu)?);
    Ok(ModeParameters::sliding(k, Friction { tau, hardening, x: x.unwrap_or(0.0), mu: mu.unwrap_or(0.0) }))
}

fn required(params: &Params, key: &'static str) -> Result<f64, EntryFault> {
    optional(params, key)?.ok_or(EntryFault::MissingParameter { key })
}

fn optional(params: &Params, key: &'static str) -> Result<Option<f64>, EntryFault> {
    match params.get(key) {
        None => Ok(None),
        Some(Value::Bool(flag)) => Ok(Some(f64::from(u8::from(*flag)))),
        Some(value) => value.as_f64().map(Some).ok_or_else(|| EntryFault::NotANumber { key, found: value.to_string() }),
    }
}

/// The keys that a bundle law is written with.
pub(super) fn write(law: &BundleParameters) -> Params {
    let (comp_type, k_p, m, z_lock) = match law.compaction {
        Compaction::Quadratic => (0.0, None, None, None),
        Compaction::Power { k_p, m } => (1.0, Some(k_p), Some(m), None),
        Compaction::LockUp { z_lock } => (2.0, None, None, Some(z_lock)),
    };
    let slides = law.transverse.friction.is_some() || law.longitudinal.friction.is_some();
    let general = [
        ("K_e", Some(law.k_e)),
        ("K_ec", Some(law.k_ec)),
        ("w_e", Some(law.w_e)),
        ("K_c", Some(law.k_c)),
        ("nu", Some(law.nu)),
        ("comp_type", Some(comp_type)),
        ("K_p", k_p),
        ("p_exp", m),
        ("z_lock", z_lock),
        ("friction", Some(f64::from(u8::from(slides)))),
    ];
    let modes = [(&law.transverse, &TRANSVERSE), (&law.longitudinal, &LONGITUDINAL)];
    let modes = modes.into_iter().flat_map(|(mode, keys)| keys.0.into_iter().zip(mode_values(mode)));
    general.into_iter().chain(modes).filter_map(|(k, v)| Some((k.to_owned(), Value::from(v?)))).collect()
}

/// Values in the order of [`ModeKeys`].
fn mode_values(mode: &ModeParameters) -> [Option<f64>; 7] {
    let Some(friction) = mode.friction else { return [Some(mode.k), None, None, None, None, None, None] };
    let (h, h_inf, kappa_s) = match friction.hardening {
        Hardening::Linear { h } => (h, None, None),
        Hardening::Saturating { h_inf, kappa_s } => (0.0, Some(h_inf), Some(kappa_s)),
    };
    [Some(mode.k), Some(friction.tau), Some(h), Some(friction.mu), Some(friction.x), h_inf, kappa_s]
}
