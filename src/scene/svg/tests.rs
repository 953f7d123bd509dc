use super::super::geographic;
use super::*;
