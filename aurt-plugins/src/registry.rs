use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use aurt_traits::{ModelEntry, Slot};

use crate::dynamic::{self, LibraryFile, LibraryModel};
use crate::error::{BuildError, LibraryProblem};
use crate::listing::{LibraryListing, ModelListing};
use crate::trust::Trust;
use crate::{Error, Span};

/// All models that can be named: the statically linked ones and those of loaded libraries, by slot and name.
#[derive(Debug, Clone, Default)]
pub struct Registry {
    models: BTreeMap<(Slot, String), Registered>,
    libraries: Vec<LibraryListing>,
    /// Which libraries may be loaded because a file names them.
    trust: Trust,
    former_names: Arc<Mutex<BTreeSet<String>>>,
}

#[derive(Debug, Clone)]
pub(crate) struct Registered {
    pub listing: ModelListing,
    /// The library's model; linked ones are found by `typetag`.
    pub library: Option<Arc<LibraryModel>>,
}

impl Registry {
    /// All slots, in the order of listings.
    pub const SLOTS: [Slot; 4] = [Slot::Coulomb, Slot::Hysteresis, Slot::Viscous, Slot::ArmTerm];

    /// The models that are linked into this program.
    ///
    /// # Errors
    /// [`Error::DuplicateModel`] if two crates register one name in one slot.
    pub fn linked() -> Result<Self, Error> {
        let mut registry = Self::default();
        for entry in inventory::iter::<ModelEntry> {
            registry.add(ModelListing::from(entry), None)?;
        }
        Ok(registry)
    }

    /// The linked models; files may name the libraries that the user trusts ([`Trust::of_user`]).
    ///
    /// # Errors
    /// As [`Self::linked`], and a list of trusted libraries that is damaged.
    pub fn of_user() -> Result<Self, Error> {
        Ok(Self { trust: Trust::of_user()?, ..Self::linked()? })
    }

    /// What to say of the files of models that this registry and its clones have read: models by former names.
    pub fn take_notes(&self) -> BTreeSet<String> {
        std::mem::take(&mut *self.former_names.lock().unwrap_or_else(PoisonError::into_inner))
    }

    pub(crate) fn note(&self, note: String) {
        self.former_names.lock().unwrap_or_else(PoisonError::into_inner).insert(note);
    }

    /// Loads a dynamic library and adds its models; all of them or, if one is refused, none. A library that is loaded
    /// already stays as it is.
    ///
    /// # Errors
    /// [`Error::Library`] if it cannot be loaded or is no plugin, [`Error::DuplicateModel`] if a model of that slot and
    /// name exists.
    pub fn load_library(&mut self, path: impl AsRef<Path>) -> Result<(), Error> {
        let path = path.as_ref();
        self.load(path, &LibraryFile::read(path)?)
    }

    fn load(&mut self, path: &Path, file: &LibraryFile) -> Result<(), Error> {
        if self.libraries.iter().any(|known| known.path == file.path) {
            return Ok(());
        }
        let (library, models) =
            dynamic::load(file).map_err(|problem| Error::Library { path: path.to_owned(), problem })?;
        let mut with_library = self.clone();
        for (listing, model) in models {
            with_library.add(listing, Some(model))?;
        }
        with_library.libraries.push(library);
        *self = with_library;
        Ok(())
    }

    /// Loads a dynamic library because a file names it: if it is loaded already, or its bytes are trusted. These bytes are
    /// loaded, whatever stands in the file by then.
    ///
    /// # Errors
    /// As [`Self::load_library`], and [`LibraryProblem::NotTrusted`].
    pub fn load_named_library(&mut self, path: &Path) -> Result<(), Error> {
        let file = LibraryFile::read(path)?;
        let is_loaded = || self.libraries.iter().any(|known| known.blake3 == file.blake3);
        if !self.trust.allows(&file.blake3) && !is_loaded() {
            return Err(Error::Library { path: path.to_owned(), problem: LibraryProblem::NotTrusted });
        }
        self.load(path, &file)
    }

    /// Says which libraries may be loaded because a file names them; none, until then.
    pub fn trust(&mut self, trust: Trust) {
        self.trust = trust;
    }

    /// Which libraries a program that this one starts may load: those that this one may, and those that it has.
    pub fn trusted(&self) -> Trust {
        let mut trust = self.trust.clone();
        self.libraries.iter().for_each(|library| trust.insert(library.blake3.clone()));
        trust
    }

    /// The loaded libraries, in the order of loading.
    pub fn libraries(&self) -> &[LibraryListing] {
        &self.libraries
    }

    fn add(&mut self, listing: ModelListing, library: Option<Arc<LibraryModel>>) -> Result<(), Error> {
        let key = (listing.slot, listing.name.clone());
        if let Some(first) = self.models.get(&key) {
            return Err(Error::DuplicateModel {
                slot: listing.slot.name(),
                name: listing.name,
                first: first.listing.origin.to_string(),
                second: listing.origin.to_string(),
            });
        }
        self.models.insert(key, Registered { listing, library });
        Ok(())
    }

    /// All models, sorted by slot and name.
    pub fn models(&self) -> impl Iterator<Item = &ModelListing> {
        self.models.values().map(|m| &m.listing)
    }

    /// The models of one slot, sorted by name.
    pub fn models_of(&self, slot: Slot) -> impl Iterator<Item = &ModelListing> {
        self.models().filter(move |m| m.slot == slot)
    }

    /// The models of a name, in any slot.
    pub fn named<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a ModelListing> {
        self.models().filter(move |m| m.name == name)
    }

    /// The model of a name in a slot.
    ///
    /// # Errors
    /// [`BuildError::UnknownModel`] with the known names and the slots that do have that name.
    pub fn model(&self, slot: Slot, name: &str) -> Result<&ModelListing, BuildError> {
        self.locate(slot, name, 0..0).map(|m| &m.listing)
    }

    pub(crate) fn locate(&self, slot: Slot, name: &str, span: Span) -> Result<&Registered, BuildError> {
        self.models.get(&(slot, name.to_owned())).ok_or_else(|| BuildError::UnknownModel {
            slot,
            name: name.to_owned(),
            known: self.names(slot),
            elsewhere: self.named(name).map(|m| m.slot).collect(),
            span,
        })
    }

    /// The names of a slot's models, sorted.
    pub fn names(&self, slot: Slot) -> Vec<String> {
        self.models_of(slot).map(|m| m.name.clone()).collect()
    }
}
