//! Tests of the public interface, against numbers from outside the code.

mod support;

mod detector;
mod flush;
mod impact;
mod jets;
mod pairs;
mod random;
mod shapes;
