//! A library without any symbol of a vendor, for a client's error about a wrong library.
