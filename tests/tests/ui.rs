//! The attribute as the compiler of the user's crate sees it: tables beside their sources, messages pinned.

#[test]
fn attribute() {
    let cases = trybuild::TestCases::new();
    cases.pass("ui/pass/*.rs");
    cases.compile_fail("ui/fail/*.rs");
}
