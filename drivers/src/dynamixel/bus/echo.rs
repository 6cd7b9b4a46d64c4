//! What earlier requests may still bring.

/// Answers that may come late or twice, by servo and length of their data, or [`PINGED`].
#[derive(Debug)]
pub(super) struct Echo {
    /// `None`: nobody knows.
    answers: Option<Vec<(u8, usize)>>,
    /// Refusals may come too, which have no data.
    refusals: bool,
    /// The length of the last clearing read.
    turn: usize,
}

/// The answer to a ping, which is as good late as early: it says the same.
pub(super) const PINGED: usize = usize::MAX;
/// How long that is.
pub(super) const PING_LENGTH: usize = 3;

/// The longest clearing read: the control table has no gap before address 14.
pub(super) const LONGEST: usize = 14;

impl Echo {
    /// Nothing has been asked yet.
    pub(super) fn none() -> Self {
        Self { answers: Some(Vec::new()), refusals: false, turn: 0 }
    }

    /// The line has been away.
    pub(super) fn unknown() -> Self {
        Self { answers: None, refusals: true, turn: 0 }
    }

    /// These answers came, and none refused: they may come again. What was a write may be refused the second time.
    pub(super) fn of(answers: Vec<(u8, usize)>) -> Self {
        let refusals = answers.iter().any(|(_, length)| *length == 0);
        Self { answers: Some(answers), refusals, turn: 0 }
    }

    /// These answers did not all come, or not as they should, and what was awaited before may be behind them.
    pub(super) fn missed(&mut self, expected: &[(u8, usize)]) {
        self.refusals = true;
        if let Some(answers) = &mut self.answers {
            let new: Vec<_> = expected.iter().filter(|answer| !answers.contains(answer)).copied().collect();
            answers.extend(new);
        }
    }

    /// Nor did the answer to a clearing read of this length.
    pub(super) fn missed_clearing(&mut self, id: u8, length: usize) {
        self.turn = length;
        self.missed(&[(id, length)]);
    }

    /// Whether something may come that looks like an answer to what expects these.
    pub(super) fn may_answer(&self, expected: &[(u8, usize)]) -> bool {
        let Some(answers) = &self.answers else { return true };
        expected.iter().any(|(id, length)| match *length {
            PINGED => answers.contains(&(*id, PING_LENGTH)),
            PING_LENGTH => answers.contains(&(*id, PING_LENGTH)) || answers.contains(&(*id, PINGED)),
            length => answers.contains(&(*id, length)) || (length == 0 && self.refusals),
        })
    }

    /// Whether a refusal may be an earlier request's.
    pub(super) fn may_refuse(&self) -> bool {
        self.refusals
    }

    /// A length for a clearing read of this servo, which no other answer has.
    pub(super) fn other_length(&self, id: u8, expected: &[(u8, usize)]) -> usize {
        let answers = self.answers.as_deref().unwrap_or_default();
        let taken = |length: &usize| {
            *length == PING_LENGTH || answers.iter().chain(expected).any(|answer| *answer == (id, *length))
        };
        // In turns, so that clearing reads differ from each other.
        let turns = (1..=LONGEST).map(|step| (self.turn + step - 1) % LONGEST + 1);
        turns.into_iter().find(|length| !taken(length)).unwrap_or(LONGEST)
    }
}
