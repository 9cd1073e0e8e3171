//! Life of a sliding bearing: wear, thermal and swelling change of the clearance, lubricant film.
//!
//! Numerics that know no bench and no run: [`crate::simulate::life`] couples them with the plant.
//!
//! * [`foundation`]: pressure between worn surfaces on an elastic foundation.
//! * [`wear`]: Archard's law on the circumferential profiles of bearing and journal.
//! * [`jump`]: extrapolation over many cycles with error control.
//! * [`thermal`]: clearance over temperature and water uptake.
//! * [`film`]: finite journal bearing with cavitation, as a table.

pub mod film;
pub mod foundation;
pub mod jump;
pub mod thermal;
pub mod wear;
