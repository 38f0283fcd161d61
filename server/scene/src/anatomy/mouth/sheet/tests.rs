//! Geometry of the sheet.
