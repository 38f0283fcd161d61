//! Text forms of single values in an exercise's file.

/// Names of sites.
pub mod site_names {
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};
    use sulcus_core::tissue::gingiva::Site;

    pub fn serialize<S: Serializer>(sites: &[Site], to: S) -> Result<S::Ok, S::Error> {
        let names: Vec<&str> = sites.iter().map(|site| site.name()).collect();
        names.serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<Site>, D::Error> {
        let names = Vec::<String>::deserialize(from)?;
        let site = |name: &String| {
            Site::from_name(name).ok_or_else(|| {
                let all = Site::ALL.map(Site::name).join(", ");
                D::Error::custom(format!("sites is `{name}`, expected one of: {all}"))
            })
        };
        names.iter().map(site).collect()
    }
}

/// Seed as a number, or as text if the seed exceeds TOML's numbers.
pub mod seed {
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serializer};

    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Written {
        Number(u64),
        Text(String),
    }

    pub fn serialize<S: Serializer>(seed: &Option<u64>, to: S) -> Result<S::Ok, S::Error> {
        match seed {
            None => to.serialize_none(),
            Some(seed) => match i64::try_from(*seed) {
                Ok(number) => to.serialize_i64(number),
                Err(_) => to.serialize_str(&seed.to_string()),
            },
        }
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<u64>, D::Error> {
        let wrong = |found: &dyn std::fmt::Display| {
            D::Error::custom(format!(
                "seed is {found}, expected a whole number from 0 to 2^64 - 1"
            ))
        };
        match Written::deserialize(from) {
            Ok(Written::Number(number)) => Ok(Some(number)),
            Ok(Written::Text(text)) => text.parse().map(Some).map_err(|_| wrong(&text)),
            Err(_) => Err(wrong(&"neither a whole number nor text")),
        }
    }
}
