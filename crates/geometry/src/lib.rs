//! Geometry of ropes for finite elements.
//!
//! - [`mesh`]: hexahedral meshes with named sets and surfaces;
//! - [`hexahedron`], [`quadrilateral`]: isoparametric maps of cells and faces;
//! - [`helix`]: lay, helices, Frenet frames, yarns in strands with a helical axis;
//! - [`fibre`]: fields of fibre frames;
//! - [`section`], [`strand`]: meshes of sections and strands;
//! - [`rope`]: ropes of several strands, their helix radius, lay and mesh;
//! - [`surface_grid`], [`spline`]: surface nodes of a strand and the smooth surface through their net;
//! - [`sizing`]: from filaments to the rope, what follows and what contradicts;
//! - [`quality`]: Jacobian, shape, volume and fibre angles of a mesh.
//!
//! Lengths are in mm, angles in radians, everything is in the reference configuration.

#![forbid(unsafe_code)]

pub mod axis;
mod check;
pub mod error;
pub mod fibre;
pub mod helix;
pub mod hexahedron;
pub mod mesh;
pub mod quadrilateral;
pub mod quality;
pub mod rope;
pub mod section;
pub mod sizing;
pub mod spline;
pub mod strand;
pub mod surface_grid;

pub use axis::{Axis, Cylindrical};
pub use error::{GeometryError, Parameter};
pub use fibre::{
    FibreField, FibresAlongHelix, HelicalFibres, Parallel, PerCellFrames, centroid_frames, fibre_frames,
    frame_from_directions,
};
pub use helix::{FrenetFrame, Handedness, Helix, Lay, Yarn, touching_pair, touching_radius, touching_radius_at_angle};
pub use hexahedron::{
    Hex8, Hex20, Hex20R, Hex27, Hexahedron, MappedPoint, QuadraturePoint, Serendipity, jacobian_of, map_point,
};
pub use mesh::{CellKind, Face, Mesh, NodeLines, extent, exterior_faces};
pub use quadrilateral::{FacePoint, Quad4, Quad8, Quad9, Quadrilateral, surface_area};
pub use rope::{
    Compaction, HelixRadius, LayBy, Rope, RopeFibres, RopeLay, RopeMesh, RopeShape, RopeSlice, RopeStrand, Sense,
    YarnLay, YarnLayBy, join_strands,
};
pub use section::{Section, SectionArea, SectionMesh};
pub use sizing::{Hierarchy, Quantity, SizingReport};
pub use strand::{MeshLines, Strand, StrandAxis, StrandEnds, StrandFibres, StrandOrigin};
pub use surface_grid::SurfaceGrid;
