//! Where the report is silent, damaged or wrong, as the page tells it.

/// What is the matter with the report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    Wrong,
    Damaged,
    Silent,
}

impl Fault {
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Wrong => "wrong",
            Self::Damaged => "damaged",
            Self::Silent => "silent",
        }
    }
}

/// One place: what is the matter, where, what it is, and what is done here.
pub(super) struct Correction {
    pub fault: Fault,
    pub place: &'static str,
    pub matter: &'static str,
    pub here: &'static str,
}

pub(super) const CORRECTIONS: [Correction; 13] = [
    Correction {
        fault: Fault::Wrong,
        place: "(4.7)-(4.12), (4.18)",
        matter: "The cross-coupled stiffness of a mass is printed as ζ R / Rm.",
        here: "ζ R, as Table 4.1 has it and as the derivation gives. Only this gives the thresholds that the report itself \
            prints; with the division they would be 0.44, 1.03 and 1.16.",
    },
    Correction {
        fault: Fault::Wrong,
        place: "(3.36)",
        matter: "g22 = g21.",
        here: "g22 = g11, which symmetry and (3.39) need.",
    },
    Correction {
        fault: Fault::Damaged,
        place: "(3.33)",
        matter: "The control distribution matrix shows a minus sign and a fraction.",
        here: "B = [0; I]: the control force enters the accelerations with weight +1.",
    },
    Correction {
        fault: Fault::Damaged,
        place: "(3.14)-(3.20)",
        matter: "ξ0² stands for ω0², and an eccentricity is missing on the right in places.",
        here: "The form with ω0 and e, which (3.21) and (3.22) confirm.",
    },
    Correction {
        fault: Fault::Wrong,
        place: "(4.12)",
        matter: "The last term of mass 3 is divided by the mass ratio of mass 1.",
        here: "By its own. In the report's example both are 0.25.",
    },
    Correction {
        fault: Fault::Wrong,
        place: "below (3.44)",
        matter: "The real part of the second eigenvalue is printed -0.44272.",
        here: "-0.44277: the last digit is wrong.",
    },
    Correction {
        fault: Fault::Damaged,
        place: "before Fig. 4.7",
        matter: "The page that states the output weights a to f of (4.26), and with it the gains, is lost.",
        here: "Weights a = b = d = e = 1, c = f = 0 (the centre mass and the end with the bearing, as the text says), and \
            gains of our own that hold one constant set stable to about R = 7.1.",
    },
    Correction {
        fault: Fault::Silent,
        place: "Table 4.2",
        matter: "Only the sum of bearing and seal stiffness is given, so the share that has the deadband is not known.",
        here: "All of it has the deadband.",
    },
    Correction {
        fault: Fault::Silent,
        place: "Figs. 3.8-3.10",
        matter: "Neither the size of the impulse nor its phase against the unbalance is given, nor whether the maximum is of \
            the force or of a component.",
        here: "Reconstructed: from rest, v_y = -2.5 at τ = 0, the larger of the two components.",
    },
    Correction {
        fault: Fault::Silent,
        place: "Figs. 3.5, 3.6, 4.17-4.26",
        matter: "Starting states, durations and integration steps are not given.",
        here: "From rest; Runge-Kutta of fourth order with at least 126 steps to the fastest turn.",
    },
    Correction {
        fault: Fault::Silent,
        place: "Figs. 3.7, 4.16",
        matter: "The unit of the force is not given.",
        here: "The control acceleration |u| in ω0² e_t: a force divided by m ω0² e_t, with m the mass at the bearing.",
    },
    Correction {
        fault: Fault::Damaged,
        place: "Figs. 3.4-4.26",
        matter: "The pictures are lost in the scan; captions and headings are left.",
        here: "Every figure is computed anew. Where text and captions give no number, agreement can only be qualitative.",
    },
    Correction {
        fault: Fault::Silent,
        place: "Figs. 4.7-4.11",
        matter: "The gains tracked over speed are not printed, nor how they were followed.",
        here: "Searched anew, held together by a price on changes of gain.",
    },
];
