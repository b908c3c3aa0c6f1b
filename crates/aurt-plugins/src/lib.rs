//! Finding models by name, reading experiments, composing robot models.
