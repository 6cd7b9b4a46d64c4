fn main() {
    for path in std::env::args().skip(1) {
        let text = std::fs::read_to_string(&path).unwrap();
        let t = std::time::Instant::now();
        let level = if std::env::var("FULL").is_ok() {
            dh_codegen::verify::Level::Full
        } else {
            dh_codegen::verify::Level::Quick
        };
        let c = dh_codegen::compile(&text, level);
        println!("{path} {:?}", t.elapsed());
        println!("{}", c.diagnostics.render(&text, &path, dh_codegen::diagnostic::Style::Plain));
        if let Some(o) = c.output {
            for f in &o.plan.functions {
                println!("  {:?} {:?}", f.kind, f.counts);
                for s in &f.stages {
                    println!("     {} <- {} [{}]", s.unknown, s.equation, s.origin);
                }
            }
            if std::env::var("RUST").is_ok() {
                println!("{}", dh_codegen::emit::rust::print(&o.model, &o.plan, &Default::default()));
            }
        }
    }
}
