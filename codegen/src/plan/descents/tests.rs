use super::{POSES, STARTS, asked, chain, met, rarest, samples};
use crate::model::{Model, Problem, Target};
use crate::symbolic::inverse_kinematics::rows;
use crate::verify::Level;

/// An elbow that is kept by a parallel linkage, on a slide.
const SLIDING: &str = "[robot]\nname = \"sliding\"\nconvention = \"standard\"\n\
    [[joint]]\ntype = \"prismatic\"\nalpha = 1.3\n\
    [[joint]]\na = 0.1\nd = 0.02\nalpha = 0.9\n\
    [[joint]]\na = 0.2\nalpha = 0.4\n\
    [[joint]]\na = 0.15\nd = 0.03\nalpha = -1.1\nfixed = 0.3\ncouple = { J3 = -1 }\n\
    [[joint]]\na = 0.05\nalpha = 0.2\n\
    [[joint]]\na = 0.04\nalpha = 0.8\n\
    [[ik]]\nname = \"given\"\ntarget = \"position_yaw\"\nfree = [\"J1\"]\n\
    [[ik]]\nname = \"whole\"\ntarget = \"position_direction\"\n";

fn problem(model: &Model, name: &str) -> Problem {
    model.problems.iter().find(|problem| problem.name == name).unwrap().clone()
}

#[test]
fn given_slides_are_lengths() {
    let model = crate::compile(SLIDING, Level::Quick).output.unwrap().model;
    let problem = problem(&model, "given");
    let chain = chain(&model, &rows::chain(&model, &problem).unwrap(), 1);
    let samples = samples(&model, &problem, &chain);
    assert_eq!(samples.len(), POSES);
    let greatest = samples.iter().map(|sample| sample.given[0].abs()).fold(0.0, f64::max);
    assert!(chain.reach < 1.0 && greatest <= chain.reach && greatest > 0.5 * chain.reach, "{greatest} m");
}

/// Each has a twin with the tool the other way round, which meets no target.
#[test]
fn solutions_that_head_the_other_way_are_not_counted() {
    let model = crate::compile(SLIDING, Level::Quick).output.unwrap().model;
    let problem = problem(&model, "given");
    let chain = chain(&model, &rows::chain(&model, &problem).unwrap(), 1);
    let mut counted = 0;
    for sample in samples(&model, &problem, &chain) {
        let asked = asked(problem.target, &sample.tip, chain.reach);
        for x in
            (1..=STARTS).filter_map(|number| chain.with(|chain| chain.descend(&asked, &sample.given, number)))
        {
            let (position, rotation) = asked.errors(&chain.with(|chain| chain.tip(&sample.given, &x)));
            assert!(position < 1e-9 && rotation < 1e-9, "off by {position} m, {rotation} rad");
        }
        counted += met(&chain, problem.target, &sample, STARTS).len();
    }
    assert!(counted > POSES);
}

/// The slide of a large arm is known to fewer places behind the point.
#[test]
fn what_is_one_solution_depends_on_the_size_of_the_arm() {
    let model = crate::compile(SLIDING, Level::Quick).output.unwrap().model;
    let problem = problem(&model, "whole");
    let plain = chain(&model, &rows::chain(&model, &problem).unwrap(), 0);
    // By a power of 2, so that all else is the same.
    let size = f64::from(1 << 20).powi(2);
    let mut large = plain.clone();
    large.reach *= size;
    for link in &mut large.links {
        link.translation = link.translation.map(|x| x * size);
    }
    let counts = [&plain, &large].map(|chain| {
        let samples = samples(&model, &problem, chain);
        samples.iter().map(|sample| met(chain, problem.target, sample, STARTS).len()).collect::<Vec<_>>()
    });
    assert_eq!(counts[0], counts[1]);
}

#[test]
fn without_solutions_there_is_no_rarest() {
    let model = crate::compile(SLIDING, Level::Quick).output.unwrap().model;
    let chain = chain(&model, &rows::chain(&model, &problem(&model, "whole")).unwrap(), 0);
    assert!(rarest(&chain, Target::PositionDirection, &[]).is_none());
}
