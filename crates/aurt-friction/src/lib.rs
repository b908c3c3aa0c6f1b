//! Joint friction models and arm terms for AURT, one model a file.
