//! Materials by name: values to start from, with their sources.

/// A named set of material keys.
pub(crate) struct Preset {
    pub(crate) name: &'static str,
    /// The keys, in TOML.
    pub(crate) keys: &'static str,
    /// One sentence.
    pub(crate) about: &'static str,
    /// Where the numbers are from.
    pub(crate) source: &'static str,
}

/// Names of [`PRESETS`], for the table of keys.
pub(crate) const NAMES: &[&str] = &[
    "dust",
    "water",
    "sea_water",
    "glycerine",
    "honey",
    "jelly",
    "rubber",
    "snow",
];

pub(crate) const PRESETS: &[Preset] = &[
    Preset {
        name: "dust",
        keys: "model = \"none\"\ndensity = 1.0",
        about: "Particles that do not push.",
        source: "a choice",
    },
    Preset {
        name: "water",
        keys: "model = \"fluid\"\ndensity = 998.2\nviscosity = 1.0016e-3\ncolor = \"#3d9be9\"",
        about: "Fresh water at 20 °C.",
        source: "IAPWS R6-95(2018) and R12-08",
    },
    Preset {
        name: "sea_water",
        keys: "model = \"fluid\"\ndensity = 1024.8\nviscosity = 1.077e-3\ncolor = \"#2f86b8\"",
        about: "Sea water of 35 g/kg salt at 20 °C.",
        source: "ITTC 7.5-02-01-03 (2011)",
    },
    Preset {
        name: "glycerine",
        keys: "model = \"fluid\"\ndensity = 1261.0\nviscosity = 1.41\ncolor = \"#d9e8ef\"",
        about: "Pure glycerine at 20 °C.",
        source: "Segur & Oberstar 1951",
    },
    Preset {
        name: "honey",
        keys: "model = \"fluid\"\ndensity = 1420.0\nviscosity = 10.0\ncolor = \"#e3a02b\"",
        about: "Honey of about 17 % water at 25 °C, taken as Newtonian.",
        source: "typical of published measurements, 5 to 20 Pa s",
    },
    Preset {
        name: "jelly",
        keys: "model = \"corotated\"\ndensity = 1000.0\nyoungs_modulus = 3.0e4\npoisson_ratio = 0.3\ncolor = \"#ed553b\"",
        about: "Firm jelly, more compressible than a real one so that large steps are possible.",
        source: "a choice; gelatine gels have E from 1 to 100 kPa",
    },
    Preset {
        name: "rubber",
        keys: "model = \"neo_hookean\"\ndensity = 1100.0\nyoungs_modulus = 1.0e6\npoisson_ratio = 0.45\ncolor = \"#3b3f46\"",
        about: "Soft rubber.",
        source: "typical of soft vulcanised rubber, E from 1 to 5 MPa",
    },
    Preset {
        name: "snow",
        keys: "model = \"snow\"\ndensity = 400.0\nyoungs_modulus = 1.4e5\npoisson_ratio = 0.2\ncritical_compression = 2.5e-2\ncritical_stretch = 7.5e-3\nhardening = 10.0\ncolor = \"#eeeef0\"",
        about: "Packed snow.",
        source: "Stomakhin 2013, table 2",
    },
];

/// The preset called `name`.
pub(crate) fn find(name: &str) -> Option<&'static Preset> {
    PRESETS.iter().find(|preset| preset.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_the_presets() {
        assert_eq!(
            PRESETS.iter().map(|preset| preset.name).collect::<Vec<_>>(),
            NAMES
        );
    }
}
