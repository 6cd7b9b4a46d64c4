//! Which joints of a chain play which part.

use super::JOINTS;

/// Which joints play which part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Chart {
    /// The joint whose axis is the line; its value comes last. Must be revolute.
    pub dropped: u8,
    /// Whether the circuit is run through towards the base.
    pub backward: bool,
    /// Which of the three joints far from the cut is hidden in the polynomial: 0, 1 or 2, counted along the circuit. Must
    /// be revolute.
    pub hidden: u8,
    /// Which of the other two the resultant eliminates.
    pub swapped: bool,
    /// Whether the resultant has a factor that is the same for all targets, to be divided out.
    pub divided: bool,
    /// Degree of the polynomial.
    pub degree: u8,
    /// How often it repeats itself in a turn of the joint; its degree is that of one period.
    pub periods: u8,
}

impl Chart {
    /// A choice of joints.
    pub const fn new(
        dropped: u8,
        backward: bool,
        hidden: u8,
        swapped: bool,
        divided: bool,
        degree: u8,
    ) -> Self {
        Self { dropped, backward, hidden, swapped, divided, degree, periods: 1 }
    }

    /// The same for a polynomial that repeats itself in a turn.
    #[must_use]
    pub const fn repeated(self, periods: u8) -> Self {
        Self { periods, ..self }
    }

    /// Degree of the polynomial over a whole turn of the joint.
    pub const fn degree_of_turn(&self) -> u8 {
        self.degree * if self.periods > 1 { self.periods } else { 1 }
    }

    /// The joint whose angle the polynomial is in.
    pub const fn unknown(&self) -> usize {
        let along = (self.hidden % 3) as usize + 3;
        self.place(along)
    }

    /// The two joints that are eliminated first.
    pub const fn eliminated(&self) -> [usize; 2] {
        [self.place(1), self.place(2)]
    }

    /// The two joints besides [`Chart::unknown`] that the resultant is in.
    pub const fn resolved(&self) -> [usize; 2] {
        match self.hidden % 3 {
            0 => [self.place(4), self.place(5)],
            1 => [self.place(3), self.place(5)],
            _ => [self.place(3), self.place(4)],
        }
    }

    /// The joint of the arm at a place of the circuit.
    pub(super) const fn place(self, along: usize) -> usize {
        let first = self.dropped as usize % JOINTS;
        if self.backward { (first + JOINTS - along) % JOINTS } else { (first + along) % JOINTS }
    }

    /// Which of joints 3, 4 and 5 of the circuit (0, 1, 2) is hidden, eliminated, last.
    pub(super) const fn places(self) -> [usize; 3] {
        let [hidden, first, last] = match self.hidden % 3 {
            0 => [0, 1, 2],
            1 => [1, 0, 2],
            _ => [2, 0, 1],
        };
        if self.swapped { [hidden, last, first] } else { [hidden, first, last] }
    }
}
