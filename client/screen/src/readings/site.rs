//! Charted sites of a tooth, as a tour visits them.

/// Site of a tooth, in the order of [`sulcus_proto::display::DisplayObject::sites`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Site {
    /// Mesial, on the cheek's side.
    MesioBuccal,
    /// Middle of the cheek's side.
    Buccal,
    /// Distal, on the cheek's side.
    DistoBuccal,
    /// Distal, on the tongue's side.
    DistoLingual,
    /// Middle of the tongue's side.
    Lingual,
    /// Mesial, on the tongue's side.
    MesioLingual,
}

impl Site {
    /// All six sites.
    pub const ALL: [Self; sulcus_proto::display::SITES] = [
        Self::MesioBuccal,
        Self::Buccal,
        Self::DistoBuccal,
        Self::DistoLingual,
        Self::Lingual,
        Self::MesioLingual,
    ];

    /// Name in files and events, one word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::MesioBuccal => "mesiobuccal",
            Self::Buccal => "buccal",
            Self::DistoBuccal => "distobuccal",
            Self::DistoLingual => "distolingual",
            Self::Lingual => "lingual",
            Self::MesioLingual => "mesiolingual",
        }
    }

    /// Site with the name `name` of files and events; `None` for another word.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|site| site.name() == name)
    }

    /// Number of the site in a display, 0 to 5.
    pub const fn number(self) -> usize {
        self as usize
    }

    /// Whether the site lies beside a neighbouring tooth. A furcation is charted only at the other sites.
    pub const fn is_proximal(self) -> bool {
        !matches!(self, Self::Buccal | Self::Lingual)
    }
}

/// Stop of a tour: a site of a tooth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Stop {
    /// FDI number of the tooth.
    pub tooth: u8,
    /// Site of the tooth.
    pub site: Site,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_numbers_come_back() {
        for (k, site) in Site::ALL.into_iter().enumerate() {
            assert_eq!(Site::from_name(site.name()), Some(site));
            assert_eq!(site.number(), k);
        }
        assert_eq!(Site::from_name("palatal"), None);
        let middle: Vec<_> = Site::ALL
            .into_iter()
            .filter(|site| !site.is_proximal())
            .collect();
        assert_eq!(middle, [Site::Buccal, Site::Lingual]);
    }
}
