//! What is said of inverse problems: why one is not solved, how many solutions it has, which joint is free.

mod common;

use common::{dhc, file};

const HEAD: &str = "[robot]\nname = \"Rows\"\nconvention = \"standard\"\n";

/// Revolute rows, none of them parallel to the next or meeting it.
fn skew(rows: usize) -> String {
    let row =
        |row: usize| format!("[[joint]]\nd = 0.{}\na = 0.{}\nalpha = 0.{}\n", row + 1, 9 - row, row + 2);
    let rows: Vec<String> = (0..rows).map(row).collect();
    format!("{HEAD}{}", rows.concat())
}

#[test]
fn a_pose_of_eight_joints_is_told_why_it_is_not_solved() {
    let path = file("eight.toml", &skew(8));
    let text = dhc(&format!("check {}", path.display())).good();
    assert!(text.contains("a pose has 6 rows, and there are 8 joints"), "{text}");
    assert!(text.contains("leave 2 to the caller, as in `free = [\"J1\", \"J2\"]`"), "{text}");

    let asked = format!("ik {} --position 0.4,0.1,0.5 --rpy 0,0,0", path.display());
    let stderr = dhc(&asked).failed(1);
    assert!(stderr.contains("says why"), "{stderr}");
}

/// What the advice leads to, under the name of what it stands for.
#[test]
fn a_problem_takes_the_place_of_the_pose() {
    let entry = "[[ik]]\nname = \"pose\"\ntarget = \"pose\"\nfree = [\"J1\", \"J2\"]\n";
    let path = file("given.toml", &format!("{}{entry}", skew(8)));
    let text = dhc(&format!("check {}", path.display())).good();
    assert!(text.contains("inverse problem pose (pose): with J1, J2 given"), "{text}");
    assert!(!text.contains("not solved"), "{text}");
}

/// A polynomial of degree 4: three axes are parallel, and the sixth joint is given.
#[test]
fn solutions_are_as_many_wherever_they_are_counted() {
    let rows = [(0.09, 0.0, "pi/2"), (0.0, -0.425, "0"), (0.0, -0.392, "0"), (0.109, 0.0, "pi/2")];
    let rows = rows.into_iter().chain([(0.0947, 0.0, "-pi/2"), (0.0, 0.0, "0")]);
    let rows = rows.map(|(d, a, alpha)| format!("[[joint]]\nd = {d:?}\na = {a:?}\nalpha = \"{alpha}\"\n"));
    let rows: Vec<String> = rows.collect();
    let tool = "[tool]\nxyz = [0.0, 0.1, 0.05]\nrpy = [0, \"pi/2\", 0]\n";
    let entry = "[[ik]]\nname = \"aim\"\ntarget = \"position_direction\"\nfree = [\"J6\"]\n";
    let path = file("aim.toml", &format!("{HEAD}{}{tool}{entry}", rows.concat()));
    for command in ["check", "equations --part ik"] {
        let text = dhc(&format!("{command} {}", path.display())).good();
        assert!(text.contains("polynomial") && text.contains("up to 8 solutions"), "{text}");
    }
}

/// Above the shoulder the base may turn as it likes.
#[test]
fn a_free_joint_is_told_by_its_name() {
    let rows = "[[joint]]\nname = \"base\"\nalpha = \"pi/2\"\n[[joint]]\na = 0.3\n[[joint]]\na = 0.3\n";
    let entry = "[[ik]]\nname = \"p\"\ntarget = \"position\"\n";
    let path = file("base.toml", &format!("{HEAD}{rows}{entry}"));
    let text = dhc(&format!("ik {} --problem p --position 0,0,0.4", path.display())).good();
    assert!(text.contains("base is free: one of its values"), "{text}");
}
