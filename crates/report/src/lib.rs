//! What people look at: charts as SVG text and self-contained HTML pages, for every command that writes a report.
//!
//! [`figure`] draws curves and maps of curves, [`heat`] tables of numbers in colours, [`axis`] finds round ticks, [`page`] puts text,
//! tables and pictures together. Values come in the unit of the axis; nothing here knows what they mean, reads files or
//! fetches anything.

pub mod axis;
pub mod figure;
pub mod heat;
pub mod page;
