mod plans;

#[test]
fn look() {
    let (model, plan) = plans::planar();
    let options = dh_codegen::emit::rust::Options { table: "planar.toml".to_owned(), ..Default::default() };
    std::fs::write("/tmp/planar.rs", dh_codegen::emit::rust::print(&model, &plan, &options)).unwrap();
    let (model, plan) = plans::polar();
    std::fs::write("/tmp/polar.rs", dh_codegen::emit::rust::print(&model, &plan, &options)).unwrap();
}
