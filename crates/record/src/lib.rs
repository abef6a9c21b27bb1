//! Films and picture sequences, written beside their final name and renamed when whole.
