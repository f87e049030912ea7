//! Errors of the crate.

/// Why a surface or a contact cannot be made, or a trial state has no answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContactError {
    /// A face that the mesh does not have.
    #[error("the mesh has no face {face} of cell {cell}")]
    NoFace {
        /// Index of the cell.
        cell: u32,
        /// Face of the cell.
        face: u8,
    },
    /// A face of too few nodes.
    #[error("face {face} has {found} nodes, its kind of cell needs {needed}")]
    FaceNodes {
        /// Index of the face.
        face: usize,
        /// Nodes given.
        found: usize,
        /// Nodes needed.
        needed: usize,
    },
    /// Faces of 20-node bricks.
    #[error(
        "the faces of 20-node bricks have no node in the middle, which a smooth surface needs: take bricks of 8 or 27"
    )]
    Serendipity,
    /// More than two faces at an edge, or two with opposite normals.
    #[error("more than two faces of the surface meet at the edge between nodes {} and {}, or their normals disagree", nodes[0], nodes[1])]
    Branching {
        /// Indices of the nodes.
        nodes: [u32; 2],
    },
    /// A node where a spline cannot go through.
    #[error(
        "{faces} faces meet at node {node}: a smooth surface needs four at inner nodes and at most two at its edge; take \
         one side of the body only, or no smoothing"
    )]
    Irregular {
        /// Index of the node.
        node: u32,
        /// Faces there.
        faces: u32,
    },
    /// Two surfaces that share a node.
    #[error("surfaces {name} share node {node}: a body cannot touch itself here")]
    SharedNode {
        /// The pair.
        name: String,
        /// Index of the node.
        node: u32,
    },
    /// An option out of range.
    #[error("{option} must be {range}, got {value}")]
    Option {
        /// Which.
        option: &'static str,
        /// What is allowed.
        range: &'static str,
        /// What was given.
        value: f64,
    },
    /// A surface without patches.
    #[error("a surface of contact {name} has no faces")]
    Empty {
        /// The pair.
        name: String,
    },
    /// The multipliers do not bring the penetration down.
    #[error(
        "contact {name}: penetration {penetration:.3e} mm after {rounds} rounds of the augmented Lagrangian, wanted \
         {wanted:.3e} mm: raise the penalty, or allow more penetration or more rounds"
    )]
    Penetration {
        /// The pair.
        name: String,
        /// Largest penetration \[mm\].
        penetration: f64,
        /// Largest allowed.
        wanted: f64,
        /// Rounds spent.
        rounds: usize,
    },
    /// A point that touches beyond the images of a surface.
    #[error(
        "contact {name}: a point {gap:.3e} mm from the images of a strand reaches the last of them: the strands have moved \
         along each other by several layers; shorten the increment, or take higher layers"
    )]
    BeyondImages {
        /// The pair.
        name: String,
        /// Its gap \[mm\].
        gap: f64,
    },
    /// A foot that is not unique: the point is as far away as the surface is curved.
    #[error(
        "contact {name}: a point {gap:.3e} mm from a surface has no unique closest point there: shorten the increment"
    )]
    NoFoot {
        /// The pair.
        name: String,
        /// Its gap \[mm\].
        gap: f64,
    },
}
