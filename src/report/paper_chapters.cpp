#include "paper_chapters.hpp"

namespace goingrate::paper {

namespace {

// Parts that several equations share.
#define FRAC(above, below) "<mfrac><mrow>" above "</mrow><mrow>" below "</mrow></mfrac>"
#define SUB(base, index) "<msub>" base index "</msub>"
#define SQUARED(base) "<msup>" base "<mn>2</mn></msup>"
#define ROOT(of) "<msqrt>" of "</msqrt>"
#define DOT(base) "<mover>" base "<mo>˙</mo></mover>"
#define DDOT(base) "<mover>" base "<mo>¨</mo></mover>"
#define NUMBER(n) "<mn>" n "</mn>"
#define SYMBOL(s) "<mi>" s "</mi>"
#define OPEN "<mo>(</mo>"
#define CLOSE "<mo>)</mo>"
#define COMMA "<mo>,</mo><mspace width=\"1em\"/>"
#define THIN "<mspace width=\"0.17em\"/>"
#define SIN "<mi>sin</mi>" THIN
#define COS "<mi>cos</mi>" THIN
#define TAN "<mi>tan</mi>" THIN
#define EXP "<mi>exp</mi>"
#define LOOP "<mo>∮</mo>"
#define DPSI THIN D PSI
#define D "<mi>d</mi>"
#define T "<mi>t</mi>"
#define M "<mi>m</mi>"
#define E "<mi>e</mi>"
#define LAMBDA "<mi>λ</mi>"
#define EPSILON "<mi>ε</mi>"
#define MU "<mi>μ</mi>"
#define MU0 SUB(MU, NUMBER("0"))
#define MU1 SUB(MU, NUMBER("1"))
#define PI "<mi>π</mi>"
#define PHI "<mi>φ</mi>"
#define PHI0 SUB(PHI, NUMBER("0"))
#define PHI1 SUB(PHI, NUMBER("1"))
#define PSI "<mi>ψ</mi>"
#define PSI0 SUB(PSI, NUMBER("0"))
#define PSI1 SUB(PSI, NUMBER("1"))
#define EQUALS "<mo>=</mo>"
#define PLUS "<mo>+</mo>"
#define MINUS "<mo>−</mo>"
#define TWO NUMBER("2")
#define RATE DOT(PSI) MINUS NUMBER("1")

constexpr std::array all_chapters{
    Chapter{
        "motion",
        "Amplitude and phase",
        "The pendulum swings as φ = λ sin ψ, in units of time in which small swings take 2π: a "
        "vector of length λ turns with ψ, and φ is its height. Half of λ² is the energy. What "
        "friction, circular error and torque do to amplitude and phase follows exactly, as long as "
        "nothing is averaged.",
        {{{"1", DDOT(PHI) PLUS TWO EPSILON DOT(PHI) PLUS SIN PHI EQUALS M OPEN PHI CLOSE},
          {"2", PHI EQUALS LAMBDA SIN PSI COMMA DOT(PHI) EQUALS LAMBDA COS PSI},
          {"3", LAMBDA EQUALS ROOT(SQUARED(PHI) PLUS SQUARED(DOT(PHI))) COMMA PSI EQUALS
           "<mi>arctan</mi>" THIN OPEN PHI "<mo>/</mo>" DOT(PHI) CLOSE},
          {"4",
           DOT(LAMBDA) EQUALS FRAC(NUMBER("1"), LAMBDA) OPEN DDOT(PHI) PLUS PHI CLOSE DOT(PHI)},
          {"5", DOT(PSI) EQUALS NUMBER("1") MINUS FRAC(NUMBER("1"), SQUARED(LAMBDA)) OPEN DDOT(PHI)
                    PLUS PHI CLOSE PHI},
          {"6", DDOT(PHI) PLUS PHI EQUALS MINUS TWO EPSILON DOT(PHI)
                    PLUS OPEN PHI MINUS SIN PHI CLOSE PLUS M OPEN PHI CLOSE}}},
        {"Sec. II"},
        {"amplitude_phase"}},
    Chapter{
        "averages",
        "Averaged over a swing",
        "Averaged over a swing, friction lowers the amplitude λ and the component of the torque m "
        "along the motion raises it; the phase ψ runs ahead of time by the circular error and by "
        "the component of the torque along the excursion; ∮ is the mean over a swing, 1/2π of the "
        "integral. Only these two moments of the torque count: escapements that share them keep "
        "the same time to first order.",
        {{{"7", DOT(LAMBDA) EQUALS MINUS TWO EPSILON LAMBDA SQUARED("<mi>cos</mi>")
                    THIN PSI PLUS OPEN LAMBDA SIN PSI MINUS SIN OPEN LAMBDA SIN PSI CLOSE CLOSE THIN
                        COS PSI PLUS M COS PSI},
          {"8", RATE EQUALS TWO EPSILON COS PSI THIN SIN PSI PLUS OPEN FRAC(NUMBER("1"), LAMBDA)
                    SIN OPEN LAMBDA SIN PSI CLOSE MINUS SIN PSI CLOSE THIN SIN PSI MINUS FRAC(
                        M, LAMBDA) SIN PSI},
          {"9", DOT(LAMBDA) EQUALS MINUS EPSILON LAMBDA PLUS LOOP M COS PSI DPSI},
          {"10", RATE EQUALS MINUS FRAC(SQUARED(LAMBDA), NUMBER("16"))
                     MINUS FRAC(NUMBER("1"), LAMBDA) LOOP M SIN PSI DPSI}}},
        {"Sec. III A"},
        {"moments"}},
    Chapter{
        "escapement",
        "The model escapement",
        "A torque μ that pushes along the motion until the pendulum is φ0 beyond the vertical, and "
        "against it from there on. Its two moments are a along the motion and b along the "
        "excursion.",
        {{{"11", PHI0 EQUALS LAMBDA SIN PSI0},
          {"12, 13", SYMBOL("a") EQUALS LOOP M COS PSI DPSI EQUALS FRAC(TWO MU PHI0, PI LAMBDA)},
          {"14", SYMBOL("b") EQUALS LOOP M SIN PSI DPSI EQUALS MINUS FRAC(TWO MU, PI) COS PSI0},
          {"15", FRAC(D SQUARED(LAMBDA), D T) EQUALS MINUS TWO EPSILON SQUARED(LAMBDA)
                     PLUS FRAC(NUMBER("4") MU PHI0, PI)},
          {"16", RATE EQUALS MINUS FRAC(SQUARED(LAMBDA), NUMBER("16")) PLUS FRAC(TWO MU, PI LAMBDA)
                     ROOT(NUMBER("1") MINUS FRAC(SQUARED(PHI0), SQUARED(LAMBDA)))}}},
        {},
        {"modesc"}},
    Chapter{
        "stationary",
        "Stationary operation",
        "Where friction and drive balance, the amplitude and the rate follow in closed form. The "
        "map shows which clocks gain and which lose; below the line the torque is too weak to "
        "carry the pendulum past φ0.",
        {{{"19", LAMBDA EQUALS PHI0 ROOT(FRAC(TWO MU, PI EPSILON PHI0))},
          {"20", RATE EQUALS MINUS FRAC(MU PHI0, NUMBER("8") PI EPSILON)
                     PLUS EPSILON ROOT(FRAC(TWO MU, PI EPSILON PHI0) MINUS NUMBER("1"))}}},
        {"Sec. IV", "Fig. 3"},
        {"rate"}},
    Chapter{"gain",
            "Losing or gaining?",
            "More torque makes a clock lose where the circular error rules and gain where the "
            "escapement error does; more friction may make it run faster.",
            {},
            {"Sec. IV A"},
            {}},
    Chapter{
        "accuracy",
        "Accuracy, and the best place for the drive",
        "The relative rate is of the order of the friction, whatever the drive. The paper expects "
        "a narrow push at the vertical, δψ wide in phase, to beat that by δψ. A push whose middle "
        "is at the vertical has no escapement error of first order, however wide it is: its place "
        "counts, not its width, and a narrow one helps only as it cannot be far off.",
        {{{"21", RATE "<mo>∼</mo>" FRAC(M, LAMBDA) "<mo>∼</mo>" EPSILON}}},
        {"Sec. IV B", "Sec. IV C"},
        {"optdriv_place", "optdriv_width"}},
    Chapter{
        "jump",
        "A jump of the torque",
        "The torque doubles at once. The rate, measured from upward crossing to upward crossing, "
        "answers at once as well, by the escapement error at the old amplitude; then the amplitude "
        "grows towards its new value as the past torque is forgotten, and the rate settles where "
        "the map says. A sudden change of the friction has no such answer at once: the rate follows "
        "the amplitude.",
        {{{"22", SUB(PSI, SYMBOL("i")) EQUALS TWO PI SYMBOL("i") COMMA SUB(DOT(PSI), SYMBOL("i"))
                     EQUALS FRAC(TWO PI, SUB(T, SYMBOL("i")) MINUS SUB(
                                             T, "<mrow>" SYMBOL("i") MINUS NUMBER("1") "</mrow>"))},
          {"17", SQUARED(LAMBDA) EQUALS FRAC(
                     NUMBER("4") PHI0, PI) "<msubsup><mo>∫</mo><mn>0</mn><mo>∞</mo></msubsup>" EXP
                     OPEN MINUS TWO EPSILON SYMBOL("τ") CLOSE MU OPEN T MINUS SYMBOL("τ")
                         CLOSE THIN D SYMBOL("τ")},
          {"18", SQUARED(LAMBDA) EQUALS FRAC(TWO PHI0, PI EPSILON) "<mo>{</mo>" MU1 MINUS OPEN MU1
                     MINUS MU0 CLOSE EXP OPEN MINUS TWO EPSILON T CLOSE "<mo>}</mo>"}}},
        {"Sec. V", "Sec. III C"},
        {"jump_zoom", "jump_rate", "jump_amplitude", "jump_friction"}},
    Chapter{
        "long",
        "A noisy drive over months",
        "Clock C, which keeps nominal time to first order, for 1e9 steps of RK4, first with a "
        "steady torque and then with one that is drawn again at every swing. It gains 1e-8 all the "
        "same, and hardly feels the noise: the swing averages it over its long memory. The "
        "averaged equations follow it, but for a secular difference: what second order, which the "
        "paper leaves open, makes of the steady torque and of the mean square of the noise.",
        {{{"23", MU EQUALS MU0 "<mo>{</mo>" NUMBER("1")
                     PLUS FRAC(SYMBOL("δ") MU OPEN T CLOSE, MU0) "<mo>}</mo>"}}},
        {"Sec. VI", "Fig. 6"},
        {"quasistat_gain", "quasistat_model", "noise_growth"}},
    Chapter{
        "closing",
        "Harmonics and length",
        "Harmonics of the torque other than the first may be added without affecting the time, and "
        "a slow change of length acts on the rate alone: the rate equation gains −δℓ/2ℓ0, that of "
        "λ nothing.",
        {},
        {"Sec. VII"},
        {"harmonics", "length"}},
    Chapter{
        "circular",
        "The circular error, and what the 1e-8 is made of",
        "The circular error by first-order averaging, of which −λ²/16 is the first term. Its "
        "second, "
        "+λ⁴/384 = +1.6e-8 at C, is not what a free swing has: that is −3λ⁴/1024 for the λ that "
        "friction and drive fix. The table takes the gain of clock C apart to second order. Its "
        "first two lines are a formula and a quadrature, the next three come from runs and limit "
        "cycles, and their sum misses the limit cycle of the full equation by terms of third "
        "order. The paper's guess, −ε²/2, is one of the parts and has the other sign than the "
        "whole; the largest part is the escapement's error in a swing that is no sinusoid. RK4's "
        "own error is measured on a swing without drive.",
        {{{"A1", FRAC(NUMBER("1"), LAMBDA) SUB(SYMBOL("J"), NUMBER("1")) OPEN LAMBDA CLOSE MINUS
                     FRAC(NUMBER("1"), TWO) "<mo>≃</mo>" MINUS FRAC(SQUARED(LAMBDA), NUMBER("16"))
                         PLUS FRAC("<msup>" LAMBDA "<mn>4</mn></msup>", NUMBER("384"))}}},
        {},
        {}},
    Chapter{
        "impulse",
        "A single impulse",
        "The other extreme of an escapement: once in a swing, at the angle φ1 = λ sin ψ1, the "
        "energy e is given in no time. Its moments follow by way of the angle, and with them the "
        "equations for amplitude and phase; in stationary operation λ² = e/2πε.",
        {{{"C1", M OPEN PHI CLOSE EQUALS E SYMBOL("δ") OPEN PHI MINUS PHI1 CLOSE},
          {"C2, C3", SYMBOL("b") EQUALS FRAC(
                         E, TWO PI) "<msubsup><mo>∫</mo><mrow><mo>−</mo><mi>π</mi></"
                                    "mrow><mi>π</mi></msubsup>" SYMBOL("δ") OPEN PHI MINUS PHI1
                                        CLOSE SIN PSI DPSI EQUALS FRAC(E, TWO PI LAMBDA) TAN PSI1},
          {"C4", DOT(LAMBDA) EQUALS MINUS EPSILON LAMBDA PLUS FRAC(E, TWO PI LAMBDA)},
          {"C5", RATE EQUALS MINUS FRAC(SQUARED(LAMBDA), NUMBER("16"))
                     MINUS FRAC(E, TWO PI SQUARED(LAMBDA)) TAN PSI1},
          {"C6", RATE EQUALS MINUS FRAC(E, NUMBER("32") PI EPSILON) MINUS EPSILON TAN PSI1}}},
        {"App. C"},
        {"impulse"}},
    Chapter{"numerics",
            "Numerical issues",
            "The paper's code chooses the torque by quadrant and angle; whether once a step or in "
            "each of RK4's four stages it does not say. Its result, 1e-8, says: not once a step. "
            "Stopped at the switches, RK4 keeps its fourth order. Both the displaced switches and "
            "the straight line along which crossings are interpolated, late by dt³ x(1 - x)"
            "(1 - 2x)/6 where x is the place in the step, make noise in the rate of a period, "
            "which adds up to nothing over many.",
            {},
            {"App. D"},
            {}},
};

#undef FRAC
#undef SUB
#undef SQUARED
#undef ROOT
#undef DOT
#undef DDOT
#undef NUMBER
#undef SYMBOL
#undef OPEN
#undef CLOSE
#undef COMMA
#undef THIN
#undef SIN
#undef COS
#undef TAN
#undef EXP
#undef LOOP
#undef DPSI
#undef D
#undef T
#undef M
#undef E
#undef LAMBDA
#undef EPSILON
#undef MU
#undef MU0
#undef MU1
#undef PI
#undef PHI
#undef PHI0
#undef PHI1
#undef PSI
#undef PSI0
#undef PSI1
#undef EQUALS
#undef PLUS
#undef MINUS
#undef TWO
#undef RATE

} // namespace

std::span<const Chapter> chapters() { return all_chapters; }

} // namespace goingrate::paper
