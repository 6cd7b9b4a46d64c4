use super::{Event, Interpreter, PlanError, Program};
use crate::model::Model;
use crate::plan::fixtures::{PLANAR_2R, PLANAR_2R_CONSTANTS, SCARA, SCARA_CONSTANTS, plan, planar_2r, scara};
use crate::plan::{FunctionKind, Plan};
use dh_core::{
    FULL_POSE, Float, Frame, IkError, Kinematics, LengthError, Rule, SolutionSet, Target, TargetKind,
};

fn planar_plan() -> Plan {
    plan(PLANAR_2R_CONSTANTS, PLANAR_2R)
}

fn scara_plan() -> Plan {
    plan(SCARA_CONSTANTS, SCARA)
}

fn check<S: Float>(model: &Model, plan: &Plan, run: impl FnOnce(&Interpreter<'_, S>)) {
    let program = Program::<S>::new(model, plan).unwrap();
    run(&program.interpreter().unwrap());
}

#[test]
fn forward_functions_do_what_the_steps_say_to_the_bit() {
    check::<f64>(&planar_2r(), &planar_plan(), |arm| {
        let q = [0.3, -1.1];
        let (s1, c1) = Float::sin_cos(q[0]);
        let (s12, c12) = Float::sin_cos(q[0] + q[1]);
        let tool = arm.fk(&q).unwrap();
        let (px, py) = (0.3 * c1 + 0.2 * c12, 0.3 * s1 + 0.2 * s12);
        assert_eq!(tool.rotation, [[c12, -s12, 0.0], [s12, c12, 0.0], [0.0, 0.0, 1.0]]);
        assert_eq!(tool.translation, [px, py, 0.0]);
        assert_eq!(arm.fk_flange(&q).unwrap(), tool);
        let mut jacobian = [[f64::NAN; 6]; 2];
        arm.jacobian_into(&q, &mut jacobian).unwrap();
        assert_eq!(jacobian[0], [-(0.3 * s1) - 0.2 * s12, 0.3 * c1 + 0.2 * c12, 0.0, 0.0, 0.0, 1.0]);
        assert_eq!(jacobian[1], [-(0.2 * s12), 0.2 * c12, 0.0, 0.0, 0.0, 1.0]);
        let mut frames = [Frame::IDENTITY; 4];
        assert_eq!(arm.frames_into(&q, &mut frames), Ok(3));
        assert_eq!(frames[1].translation, [0.3 * c1, 0.3 * s1, 0.0]);
        assert_eq!(frames[2], tool);
        assert_eq!((arm.dof(), arm.rows(), arm.name(), arm.fingerprint()), (2, 2, "hand-made", 42));
    });
}

#[test]
fn wrong_lengths_are_errors() {
    check::<f64>(&planar_2r(), &planar_plan(), |arm| {
        assert_eq!(arm.fk(&[0.0]), Err(LengthError { expected: 2, got: 1 }));
        assert_eq!(arm.jacobian_into(&[0.0; 2], &mut [[0.0; 6]]), Err(LengthError { expected: 2, got: 1 }));
        let mut frames = [Frame::IDENTITY; 2];
        assert_eq!(arm.frames_into(&[0.0; 2], &mut frames), Err(LengthError { expected: 3, got: 2 }));
    });
}

#[test]
fn inverse_problems_give_every_branch() {
    check::<f64>(&planar_2r(), &planar_plan(), |arm| {
        let mut solutions = SolutionSet::new();
        arm.ik_into("point", &Target::Xy([0.25, 0.3]), &mut solutions).unwrap();
        assert_eq!((solutions.len(), solutions.dof()), (2, 2));
        for solution in solutions.iter() {
            let [x, y, _] = arm.fk(solution.q).unwrap().translation;
            assert!((x - 0.25).abs() < 1e-15 && (y - 0.3).abs() < 1e-15);
        }
        let elbows: Vec<f64> = solutions.iter().map(|solution| solution.q[1]).collect();
        assert!((elbows[0] + elbows[1]).abs() < 1e-15 && elbows[0] > 0.1);
        // Only one of them turns the first joint by less than 2 rad; the tool must stay beyond x = -0.4 m.
        arm.ik_within("point", &Target::Xy([-0.3, 0.25]), None, &mut solutions).unwrap();
        assert!(solutions.iter().all(|solution| solution.q[0] <= 2.5));
        let error = arm.ik_within("point", &Target::Xy([-0.41, 0.05]), None, &mut solutions).unwrap_err();
        assert!(
            matches!(error, IkError::OutsideLimits { joint: 0, .. } | IkError::Forbidden { .. }),
            "{error}"
        );
        assert!(arm.check(&[0.1, 0.2]).is_ok() && arm.check(&[2.6, 0.0]).unwrap_err().iter().count() == 2);
    });
    check::<f64>(&scara(), &scara_plan(), |arm| {
        let q = [0.4, -0.9, 0.1, 1.3];
        let mut solutions = SolutionSet::new();
        arm.ik_into(FULL_POSE, &Target::Pose(arm.fk(&q).unwrap()), &mut solutions).unwrap();
        assert_eq!(solutions.len(), 2);
        let near = solutions.nearest(&q).unwrap();
        assert!(near.q.iter().zip(q).all(|(found, asked)| (found - asked).abs() < 1e-12), "{near:?}");
    });
}

#[test]
fn what_cannot_be_asked_is_refused() {
    check::<f64>(&scara(), &scara_plan(), |arm| {
        let mut solutions = SolutionSet::new();
        let mut ask = |problem: &str, target| arm.ik_into(problem, &target, &mut solutions).unwrap_err();
        assert_eq!(ask("nothing", Target::Xy([0.0; 2])), IkError::UnknownProblem);
        assert_eq!(
            ask("point", Target::Xy([0.0; 2])),
            IkError::WrongTarget { expected: TargetKind::Position }
        );
        assert_eq!(ask("point", Target::Position([f64::NAN, 0.0, 0.0])), IkError::NotFinite);
        let IkError::Unreachable { step, excess } = ask("point", Target::Position([0.8, 0.0, 0.3])) else {
            panic!("0.8 m is out of reach");
        };
        assert_eq!((step.index, step.rows, step.prismatic), (1, 0b10, false));
        assert!(excess > 0.0);
        assert_eq!(
            arm.problems().iter().map(|problem| (problem.name, problem.target)).collect::<Vec<_>>(),
            [
                (FULL_POSE, TargetKind::Pose),
                ("point", TargetKind::Position),
                ("point_left", TargetKind::Position)
            ]
        );
    });
}

#[test]
fn conditions_keep_what_they_allow() {
    let (model, plan) = (scara(), scara_plan());
    check::<f64>(&model, &plan, |arm| {
        let mut solutions = SolutionSet::new();
        let target = Target::Position([0.4, 0.2, 0.2]);
        arm.ik_into("point", &target, &mut solutions).unwrap();
        assert_eq!(solutions.len(), 2);
        arm.ik_into("point_left", &target, &mut solutions).unwrap();
        assert_eq!(solutions.len(), 1);
        assert!(solutions.iter().all(|solution| solution.q[1] < 0.0));
        // The elbow is stretched: theta2 = 0 to rounding, which `<=` includes.
        arm.ik_into("point_left", &Target::Position([0.6, 0.0, 0.2]), &mut solutions).unwrap();
        assert_eq!(solutions.len(), 1);
    });
    let mut strict = scara();
    strict.problems[1].filters[0].strict = true;
    strict.problems[1].filters[0].form.constant = crate::plan::fixtures::angle(180);
    check::<f64>(&strict, &plan, |arm| {
        // theta2 + pi < 0 holds nowhere.
        let answer = arm.ik_into("point_left", &Target::Position([0.4, 0.2, 0.2]), &mut SolutionSet::new());
        let Err(IkError::Forbidden { rule: Rule::Where { index: 0, excess } }) = answer else {
            panic!("{answer:?}")
        };
        assert!(excess > 0.0);
    });
}

#[test]
fn traces_tell_every_step_in_order() {
    check::<f64>(&planar_2r(), &planar_plan(), |arm| {
        let mut steps = Vec::new();
        let tool = arm
            .trace_fk(&[0.0, 0.0], |event| {
                let Event::Value { name, value } = event else { panic!("{event:?}") };
                steps.push((name.to_owned(), value));
            })
            .unwrap();
        let names: Vec<&str> = steps.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["s1", "c1", "s12", "c12", "px", "py"]);
        assert_eq!(steps[4].1, tool.translation[0]);
        let mut events = Vec::new();
        let target = Target::Xy([0.25, 0.3]);
        arm.trace_ik("point", &target, &[], None, &mut SolutionSet::new(), |event| {
            events.push(match event {
                Event::Value { name, .. } => name.to_owned(),
                Event::Stage { index, stage, roots } => format!("stage {index} {}: {roots}", stage.unknown),
                Event::Root { stage, number, name, .. } => format!("root {stage}.{number} {name}"),
                Event::Candidate { kept, q, .. } => format!("{} joints: {kept}", q.len()),
                Event::Done { stage } => format!("done {stage}"),
            });
        })
        .unwrap();
        let branch = |number| {
            let root = format!("root 0.{number} theta2");
            let rest =
                ["s2", "c2", "x", "y", "stage 1 theta1: 1", "root 1.0 theta1", "2 joints: true", "done 1"];
            std::iter::once(root).chain(rest.map(str::to_owned)).collect::<Vec<_>>()
        };
        let expected =
            [vec!["stage 0 theta2: 2".to_owned()], branch(0), branch(1), vec!["done 0".to_owned()]].concat();
        assert_eq!(events, expected);
        let mut dead = Vec::new();
        let far =
            arm.trace_ik("point", &Target::Xy([2.0, 0.0]), &[], None, &mut SolutionSet::new(), |event| {
                if let Event::Stage { index, roots, .. } = event {
                    dead.push((index, roots));
                }
            });
        assert!(matches!(far, Err(IkError::Unreachable { .. })));
        assert_eq!(dead, [(0, 0)]);
    });
}

#[test]
fn runs_in_f32() {
    check::<f32>(&scara(), &scara_plan(), |arm| {
        let q = [0.4_f32, -0.9, 0.1, 1.3];
        let tool = arm.fk(&q).unwrap();
        let mut solutions = SolutionSet::new();
        arm.ik_into(FULL_POSE, &Target::Pose(tool), &mut solutions).unwrap();
        assert_eq!(solutions.len(), 2);
        let near = solutions.nearest(&q).unwrap();
        assert!(near.q.iter().zip(q).all(|(found, asked)| (found - asked).abs() < 1e-5), "{near:?}");
        assert_eq!(arm.rules().joints[2].limits.unwrap().max, 0.25_f32);
        check::<f64>(&scara(), &scara_plan(), |exact| {
            let exact = exact.fk(&q.map(f64::from)).unwrap();
            let difference = f64::from(tool.translation[0]) - exact.translation[0];
            assert!(difference != 0.0 && difference.abs() < 1e-6);
        });
    });
}

#[test]
fn plans_that_cannot_be_run_are_refused() {
    let model = planar_2r();
    let error = |change: &dyn Fn(&mut Plan)| {
        let mut plan = planar_plan();
        change(&mut plan);
        Program::<f64>::new(&model, &plan).and_then(|program| program.interpreter().map(|_| ())).unwrap_err()
    };
    let mutated = |from: &str, to: &str| {
        let plan = plan(PLANAR_2R_CONSTANTS, &PLANAR_2R.replace(from, to));
        Program::<f64>::new(&model, &plan).map(|_| ()).unwrap_err()
    };
    assert_eq!(
        error(&|plan| plan.functions.retain(|function| function.kind != FunctionKind::Frames)),
        PlanError::Missing { kind: FunctionKind::Frames }
    );
    assert_eq!(error(&|plan| plan.constants.clear()), PlanError::Constant { index: 0 });
    assert_eq!(error(&|plan| plan.functions[0].values.truncate(4)), PlanError::Value { index: 4 });
    assert_eq!(error(&|plan| plan.functions[5].stages.clear()), PlanError::Stage { index: 0 });
    assert_eq!(
        error(&|plan| plan.functions[5].kind = FunctionKind::Inverse(Some(7))),
        PlanError::Problem { index: 7 }
    );
    assert_eq!(error(&|plan| plan.functions[0].inputs = 3), PlanError::Inputs { expected: 2, got: 3 });
    assert_eq!(
        error(&|plan| plan.functions[0].steps.reverse()),
        PlanError::Undefined { value: "s1".to_owned() }
    );
    assert_eq!(
        error(&|plan| {
            let steps = plan.functions[5].steps.clone();
            plan.functions[0].steps.extend(steps);
        }),
        PlanError::Solving
    );
    assert_eq!(
        mutated("accept theta1, theta2", "accept theta1"),
        PlanError::Candidate { expected: 2, got: 1 }
    );
    assert_eq!(
        mutated("0, 0, 0, 1\nframes", "0, 0, 0\nframes"),
        PlanError::Outputs { expected: 24, got: 23 }
    );
}

#[test]
fn values_of_a_branch_are_unknown_outside_of_it() {
    let text = PLANAR_2R.replace("      accept theta1, theta2", "      k = 1\n    accept k, theta2");
    let plan = plan(PLANAR_2R_CONSTANTS, &text);
    let error = Program::<f64>::new(&planar_2r(), &plan).unwrap_err();
    assert_eq!(error, PlanError::Undefined { value: "k".to_owned() });
}
