use std::fs;
use std::path::{Path, PathBuf};

use crate::case::{Plan, World};
use crate::product::{Failure, OutputFolder, pretty};
use serde::{Deserialize, Serialize};

#[derive(Debug, Clone)]
pub struct Place {
    root: PathBuf,
}

/// What a world's folder holds the proof of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Proof {
    pub seed: u64,
    pub cases: usize,
    /// Names of the experiments that effects are added to.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub into: Vec<String>,
    /// Lines on cases that the plan asks for and the world does not have.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub remarks: Vec<String>,
    pub plan: Plan,
}

/// The file that says which proof a folder holds.
const PROOF: &str = "proof.json";
/// Its plan alone, for programs that make cases.
const PLAN: &str = "plan.json";

/// Folders of a proof, each called as it is.
macro_rules! folders {
    ($($(#[$doc:meta])* $name:ident,)+) => {
        $($(#[$doc])* pub fn $name(&self) -> PathBuf { self.root.join(stringify!($name)) })+
    };
}

impl Place {
    pub fn new(proof: &Path, world: World) -> Self {
        Self { root: proof.join(world.name()) }
    }

    pub fn root(&self) -> &Path {
        &self.root
    }

    /// The plan as a file, for programs that make cases.
    pub fn plan(&self) -> PathBuf {
        self.root.join(PLAN)
    }

    folders! {
        /// Folder of the case folders, while they are needed.
        cases,
        sealed,
        verdicts,
        /// Folder of the verdicts of diagnoses that were not allowed to know what was in the case.
        removed,
        /// Folder of the verdicts of diagnoses that examine nothing but what is in the case.
        oracle,
        /// Folder of the verdicts on cases that are written differently, variant by variant.
        variants,
        /// Folder of the recordings without effects, while they are needed.
        references,
        /// Folder of the reasons why cases could not be made.
        unmade,
    }

    pub fn results(&self) -> [PathBuf; 6] {
        [self.sealed(), self.verdicts(), self.removed(), self.oracle(), self.variants(), self.unmade()]
    }

    /// Makes the folders for a proof and writes down which it is.
    pub fn create(&self, proof: &Proof) -> Result<(), Failure> {
        if let Some(other) = self.proof()?
            && other != *proof
        {
            return Err(Failure::output(
                "--out",
                &self.root,
                "holds a proof of another plan or seed",
                "name another folder",
            ));
        }
        for folder in self.results().into_iter().chain([self.cases(), self.references()]) {
            fs::create_dir_all(&folder).map_err(|source| Failure::write(folder, source))?;
        }
        let text = pretty(&serde_json::json!(proof));
        OutputFolder::nested("--out", &self.root)?.write(&[(PROOF.to_owned(), text.into_bytes())])
    }

    /// Which proof the folder holds, if any.
    pub fn proof(&self) -> Result<Option<Proof>, Failure> {
        let path = self.root.join(PROOF);
        let Ok(text) = fs::read_to_string(&path) else { return Ok(None) };
        let proof = serde_json::from_str(&text).map_err(|error| {
            Failure::unfit(path, error.to_string(), "name the folder that `aurt-lab prove --out` wrote")
        })?;
        Ok(Some(proof))
    }
}
