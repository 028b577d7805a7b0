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
    "honey",
    "mercury",
    "ketchup",
    "mud",
    "jelly",
    "rubber",
    "snow",
];

/// All of them. Numbers and sources are those of the simulator's own presets.
pub(crate) const PRESETS: &[Preset] = &[
    Preset {
        name: "dust",
        keys: "model = \"none\"\ndensity = 1.0",
        about: "Particles that do not push.",
        source: "a choice",
    },
    Preset {
        name: "water",
        keys: "model = \"fluid\"\ndensity = 998.2\nviscosity = 1.002e-3\ncolor = \"#3d9be9\"",
        about: "Fresh water at 20 °C.",
        source: "IAPWS; CRC Handbook of Chemistry and Physics",
    },
    Preset {
        name: "sea_water",
        keys: "model = \"fluid\"\ndensity = 1024.8\nviscosity = 1.072e-3\ncolor = \"#2f86b8\"",
        about: "Sea water at 20 °C with 35 g/kg of salt.",
        source: "UNESCO equation of state 1980; Landolt–Börnstein V/3a, 1986",
    },
    Preset {
        name: "honey",
        keys: "model = \"fluid\"\ndensity = 1420.0\nviscosity = 19.0\ncolor = \"#e3a02b\"",
        about: "Clover honey with 16 % of water near 20 °C.",
        source: "Munro 1943",
    },
    Preset {
        name: "mercury",
        keys: "model = \"fluid\"\ndensity = 13534.0\nviscosity = 1.526e-3\ncolor = \"#b9bec4\"",
        about: "Mercury at 25 °C.",
        source: "CRC Handbook of Chemistry and Physics",
    },
    Preset {
        name: "ketchup",
        keys: "model = \"fluid\"\ndensity = 1140.0\nrheology = \"herschel-bulkley\"\nyield_stress = 32.0\nconsistency = 18.7\nflow_index = 0.27\ncolor = \"#b3261e\"",
        about: "Tomato ketchup at 25 °C; its density is a choice.",
        source: "Steffe 1996, after Higgs and Norrington 1971",
    },
    Preset {
        name: "mud",
        keys: "model = \"fluid\"\ndensity = 1200.0\nrheology = \"herschel-bulkley\"\nyield_stress = 25.0\nconsistency = 0.07\ncolor = \"#8a5a44\"",
        about: "Water with 27.4 % of clay by volume.",
        source: "Komatina and Jovanović 1997",
    },
    Preset {
        name: "jelly",
        keys: "model = \"corotated\"\ndensity = 1010.0\nyoungs_modulus = 4.3e3\npoisson_ratio = 0.45\ncolor = \"#ed553b\"",
        about: "Gelatine, one part to twenty of water; ν = 0.45 rather than nearly ½.",
        source: "Bonavia et al., arXiv:2512.20502",
    },
    Preset {
        name: "rubber",
        keys: "model = \"neo_hookean\"\ndensity = 930.0\nyoungs_modulus = 2.0e6\npoisson_ratio = 0.49\ncolor = \"#3b3f46\"",
        about: "Vulcanised natural rubber; ν = 0.49 rather than 0.4999.",
        source: "Ashby, Materials Selection in Mechanical Design",
    },
    Preset {
        name: "snow",
        keys: "model = \"snow\"\ndensity = 400.0\nyoungs_modulus = 1.4e5\npoisson_ratio = 0.2\ncritical_compression = 2.5e-2\ncritical_stretch = 7.5e-3\nhardening = 10.0\ncolor = \"#eeeef0\"",
        about: "The snow of the paper.",
        source: "Stomakhin 2013",
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

    /// The simulator has presets too, for those who write no scenes: same names, same numbers.
    #[test]
    fn numbers_are_those_of_the_simulator() {
        use lahar::Model;
        let own: Vec<&str> = NAMES
            .iter()
            .copied()
            .filter(|name| *name != "dust")
            .collect();
        let simulators: Vec<&str> = lahar::material::Preset::all()
            .map(|preset| preset.name)
            .collect();
        assert_eq!(own, simulators);
        for name in own {
            let text = format!(
                "dimension = 3\ndx = 0.1\n[materials.m]\npreset = \"{name}\"\n[[bodies]]\nmaterial = \"m\"\n\
                 shape = {{ ball = {{ center = [0, 0, 0], radius = 1 }} }}"
            );
            let material = crate::scene::Scene::parse(&text, "a", &[])
                .unwrap()
                .simulated_materials()[0]
                .clone();
            let theirs = lahar::material::preset(name, material.sound_speed()).unwrap();
            assert_eq!(material.density, theirs.density, "{name}");
            match (material.model, theirs.model) {
                (Model::Fluid(a), Model::Fluid(mut b)) => {
                    assert!((a.bulk_modulus / b.bulk_modulus - 1.0).abs() < 1e-12);
                    b.bulk_modulus = a.bulk_modulus;
                    assert_eq!(a, b, "{name}");
                }
                (a, b) => assert_eq!(a, b, "{name}"),
            }
        }
    }
}
