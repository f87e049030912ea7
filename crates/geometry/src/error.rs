//! Errors of the crate: every variant carries the numbers that caused it.

use std::fmt;

/// A scalar parameter of a helix, a section or a strand, named in error messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Parameter {
    /// Radius of a section or of a strand \[mm\].
    Radius,
    /// Radius of a helix \[mm\].
    HelixRadius,
    /// Length of a strand along its axis \[mm\].
    Length,
    /// Lay length with the sign of the handedness \[mm\].
    Pitch,
    /// Angle between a helix and its axis \[rad\].
    Angle,
    /// Length of the axis per turn of what is laid around it, without sign \[mm\].
    LayLength,
    /// Arc length of a helix per turn \[mm\].
    ArcLength,
    /// Turning of a helix per length of its axis \[rad/mm\].
    TwistRate,
    /// Half side of the core square over the radius of the section \[-\].
    CoreFraction,
    /// Outward bulge of the sides of the core square over its half side \[-\].
    CoreBulge,
    /// Phase angle \[rad\].
    Phase,
    /// Norm of an axis direction, or of the part of a reference direction normal to it \[-\].
    Direction,
    /// Coordinate of the origin of an axis \[mm\].
    Origin,
    /// Number of core cells per side.
    CoreCells,
    /// Number of rings around the core.
    Rings,
    /// Number of layers along the strand.
    Layers,
    /// Number of strands in a rope.
    Strands,
    /// Degree of compaction of strands \[-\].
    Compaction,
    /// Distance between neighbouring strands over their radius \[-\].
    Gap,
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Radius => "radius [mm]",
            Self::HelixRadius => "helix radius [mm]",
            Self::Length => "length [mm]",
            Self::Pitch => "pitch [mm]",
            Self::Angle => "angle [rad]",
            Self::LayLength => "lay length [mm]",
            Self::TwistRate => "twist rate [rad/mm]",
            Self::ArcLength => "arc length per turn [mm]",
            Self::CoreFraction => "core fraction",
            Self::CoreBulge => "core bulge",
            Self::Phase => "phase [rad]",
            Self::Direction => "norm of a direction",
            Self::Origin => "coordinate of an origin [mm]",
            Self::CoreCells => "core cells per side",
            Self::Rings => "number of rings",
            Self::Layers => "number of layers",
            Self::Strands => "number of strands",
            Self::Compaction => "degree of compaction",
            Self::Gap => "gap over the radius",
        })
    }
}

/// What is wrong with a mesh, a curve or a set of parameters.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GeometryError {
    /// A parameter that must be positive and finite is not.
    #[error("{parameter} must be positive and finite, got {value}")]
    NotPositive {
        /// The parameter.
        parameter: Parameter,
        /// Its value.
        value: f64,
    },
    /// A parameter that must be finite is not.
    #[error("{parameter} must be finite, got {value}")]
    NotFinite {
        /// The parameter.
        parameter: Parameter,
        /// Its value.
        value: f64,
    },
    /// A parameter lies outside its range.
    #[error("{parameter} must lie between {least} and {greatest}, got {value}")]
    OutOfRange {
        /// The parameter.
        parameter: Parameter,
        /// Its value.
        value: f64,
        /// Lower bound.
        least: f64,
        /// Upper bound.
        greatest: f64,
    },
    /// A count is too small or too large.
    #[error("{parameter} must lie between {least} and {greatest}, got {value}")]
    Count {
        /// The parameter.
        parameter: Parameter,
        /// Its value.
        value: usize,
        /// Smallest allowed value.
        least: usize,
        /// Largest allowed value.
        greatest: usize,
    },
    /// The core of a section must have an even number of cells per side, so that a node lies on the axis.
    #[error("core cells per side must be even, got {value}")]
    OddCore {
        /// Cells per side.
        value: usize,
    },
    /// Strands of this thickness touch along the rope however large their helix: the lay length is too short.
    #[error("{strands} strands of radius {radius} mm do not fit into the lay length {lay_length} mm")]
    StrandsDoNotFit {
        /// Number of strands.
        strands: usize,
        /// Radius of a strand \[mm\].
        radius: f64,
        /// Lay length \[mm\].
        lay_length: f64,
    },
    /// An outer diameter determines the lay or the compaction of touching strands without a core, and one of them only.
    #[error(
        "the outer diameter {outer_diameter} mm determines nothing here: it gives the lay or else the compaction of \
        touching strands without a core"
    )]
    Undetermined {
        /// Outer diameter \[mm\].
        outer_diameter: f64,
    },
    /// Strands to be joined are meshed with different kinds of cells.
    #[error("strand {strand} is meshed with another kind of brick than strand 1")]
    KindsDiffer {
        /// One-based number of the strand.
        strand: usize,
    },
    /// Strands on a core are flattened against each other, which they do not touch.
    #[error("strands around a core cannot be flattened against each other")]
    CompactionOnCore,
    /// Strands of a rope are laid by the smooth surfaces through the nodes of their faces.
    #[error("strands of {nodes}-node bricks make no rope: their faces have no node in the middle for a smooth surface")]
    NoSmoothSurface {
        /// Nodes per cell.
        nodes: usize,
    },
    /// No lay angle from 0 to 60 deg, or no compaction, lets the strands touch at this outer diameter.
    #[error("the outer diameter {outer_diameter} mm must lie between {least} and {greatest} mm")]
    OuterDiameter {
        /// Outer diameter \[mm\].
        outer_diameter: f64,
        /// Least outer diameter, of straight or of fully compacted strands \[mm\].
        least: f64,
        /// Largest outer diameter, of strands laid at 60 deg or of round ones \[mm\].
        greatest: f64,
    },
    /// Strands laid on a core overlap each other.
    #[error("{strands} strands on the core (helix radius {helix_radius} mm) overlap: gap {gap} of their radius")]
    OuterStrandsOverlap {
        /// Number of outer strands.
        strands: usize,
        /// Radius of their helices \[mm\].
        helix_radius: f64,
        /// Gap between neighbours over their radius, negative.
        gap: f64,
    },
    /// A strand on a helical axis is thicker than the radius of curvature of that axis: its sections overlap.
    #[error("strand radius {radius} mm reaches the radius of curvature {curvature_radius} mm of its axis")]
    SectionsOverlap {
        /// Radius of the strand \[mm\].
        radius: f64,
        /// Radius of curvature of its axis \[mm\].
        curvature_radius: f64,
    },
    /// Yarns cross a plane normal to the rope axis more than once: a flat section that follows them folds.
    #[error("a flat section along the yarns folds: radius x twist rate x tan(lay angle) = {product} reaches 1")]
    FlatSectionFolds {
        /// Radius of the strand times the twist rate of its yarns times the tangent of the lay angle of its axis.
        product: f64,
    },
    /// A cell of a section mesh is folded or degenerate.
    #[error("quadrilateral {cell} of the section is folded: least Jacobian determinant {determinant} mm^2")]
    SectionFolds {
        /// Zero-based index of the quadrilateral.
        cell: usize,
        /// Its least Jacobian determinant \[mm^2\].
        determinant: f64,
    },
    /// The mesh has more nodes or bricks than 32-bit indices can count.
    #[error("the mesh would have {points} nodes and {cells} bricks, more than 32-bit indices can count")]
    TooLarge {
        /// Nodes.
        points: u128,
        /// Bricks.
        cells: u128,
    },
    /// The connectivity is not a whole number of cells.
    #[error("connectivity of {length} entries is not a multiple of {nodes} nodes per brick")]
    ConnectivityLength {
        /// Entries of the connectivity.
        length: usize,
        /// Nodes per cell.
        nodes: usize,
    },
    /// The number of labels differs from the number of items.
    #[error("{labels} labels for {items} nodes or bricks")]
    LabelCount {
        /// Number of labels.
        labels: usize,
        /// Number of nodes or cells.
        items: usize,
    },
    /// The same label is given twice.
    #[error("label {label} is given twice")]
    DuplicateLabel {
        /// The label.
        label: u64,
    },
    /// A cell refers to a node that does not exist.
    #[error("brick {cell_label}: node index {index} of {points} nodes")]
    PointIndex {
        /// Label of the cell.
        cell_label: u64,
        /// Zero-based node index.
        index: u32,
        /// Number of nodes.
        points: usize,
    },
    /// A cell uses one node twice.
    #[error("brick {cell_label} uses node {point_label} twice")]
    DuplicatePoint {
        /// Label of the cell.
        cell_label: u64,
        /// Label of the node.
        point_label: u64,
    },
    /// A coordinate is not finite.
    #[error("node {point_label} has the coordinates ({x}, {y}, {z})")]
    Coordinate {
        /// Label of the node.
        point_label: u64,
        /// Coordinate x \[mm\].
        x: f64,
        /// Coordinate y \[mm\].
        y: f64,
        /// Coordinate z \[mm\].
        z: f64,
    },
    /// A set refers to a node or cell that does not exist.
    #[error("a set holds index {index}, but there are {items} items")]
    SetIndex {
        /// Zero-based index in the set.
        index: u32,
        /// Number of nodes or cells.
        items: usize,
    },
    /// A surface refers to a cell or a face that does not exist.
    #[error("a surface holds face {face} of brick index {cell}, but there are {cells} bricks of 6 faces")]
    FaceIndex {
        /// Zero-based cell index.
        cell: u32,
        /// Face, 0 to 5.
        face: u8,
        /// Number of cells.
        cells: usize,
    },
    /// Some nodes belong to no cell.
    #[error("{count} nodes belong to no brick, the first is node {first_label}")]
    UnusedPoints {
        /// How many.
        count: usize,
        /// Label of the first.
        first_label: u64,
    },
    /// A cell is inverted or degenerate at some point.
    #[error("brick {cell_label} is inverted: Jacobian determinant {determinant} mm^3")]
    Inverted {
        /// Label of the cell.
        cell_label: u64,
        /// Least Jacobian determinant found in it \[mm^3\].
        determinant: f64,
    },
    /// Several cells are inverted or degenerate.
    #[error("{} bricks are inverted, the worst is brick {worst_label} with Jacobian determinant {determinant} mm^3",
        cell_labels.len())]
    InvertedCells {
        /// Labels of all inverted cells, in mesh order.
        cell_labels: Vec<u64>,
        /// Label of the worst one.
        worst_label: u64,
        /// Its least Jacobian determinant \[mm^3\].
        determinant: f64,
    },
    /// The isoparametric map is singular or inverted at a point.
    #[error("Jacobian determinant {determinant} mm^3 at xi = ({}, {}, {})", xi[0], xi[1], xi[2])]
    SingularMap {
        /// Determinant of the Jacobian matrix \[mm^3\].
        determinant: f64,
        /// Natural coordinates of the point.
        xi: [f64; 3],
    },
    /// A fibre field has no direction for this cell.
    #[error("cell index {cell} has no fibre frame: {frames} frames are given")]
    FrameIndex {
        /// Zero-based cell index.
        cell: usize,
        /// Number of frames.
        frames: usize,
    },
    /// The columns of a frame are not orthonormal and right-handed.
    #[error("frame {index} is not orthonormal and right-handed: it deviates by {deviation}")]
    NotOrthonormal {
        /// Zero-based index of the frame.
        index: usize,
        /// Largest entry of F^T F - 1, or |det F - 1| where larger.
        deviation: f64,
    },
    /// The nearest point of a curve was not found, because a coordinate is not finite.
    #[error("no nearest point of the helix for ({}, {}, {}) mm", point[0], point[1], point[2])]
    NoNearestPoint {
        /// The point \[mm\].
        point: [f64; 3],
    },
    /// A point lies at or beyond the centre of curvature of a strand axis: no yarn of the strand passes there.
    #[error("({}, {}, {}) mm lies {distance} mm towards the centre of curvature, {curvature_radius} mm away",
        point[0], point[1], point[2])]
    BeyondCurvature {
        /// The point \[mm\].
        point: [f64; 3],
        /// Distance from the axis towards the centre of curvature \[mm\].
        distance: f64,
        /// Radius of curvature of the axis \[mm\].
        curvature_radius: f64,
    },
    /// A direction for a fibre frame is zero, not finite, or parallel to the fibre.
    #[error("fibre ({}, {}, {}) and second direction ({}, {}, {}) span no frame",
        fibre[0], fibre[1], fibre[2], second[0], second[1], second[2])]
    NoFrame {
        /// Direction of the fibre.
        fibre: [f64; 3],
        /// Second direction.
        second: [f64; 3],
    },
}
