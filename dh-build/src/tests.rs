use super::{Build, BuildError, FindError, MAX_BYTES, ScalarType, Source, Types};
use std::fs;
use std::path::{Path, PathBuf};

/// A crate's folder of its own for each test, removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("dh-build-{name}-{}", std::process::id()));
        fs::create_dir_all(path.join("src/arms")).unwrap();
        fs::create_dir_all(path.join("robots")).unwrap();
        Folder(path)
    }

    fn write(&self, file: &str, text: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(file);
        fs::write(&path, text).unwrap();
        path
    }

    fn find(&self, name: &str) -> Result<Source, FindError> {
        Source::for_macro(name, Some(&self.0.join("src/arms/mod.rs")), Some(&self.0))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[test]
fn macros_look_beside_the_source_then_in_the_root_then_in_robots() {
    let folder = Folder::new("order");
    for (file, text) in [("robots/arm.toml", "robots"), ("arm.toml", "root"), ("src/arms/arm.toml", "beside")]
    {
        let path = folder.write(file, text);
        let expected = Source { name_shown: file.to_owned(), path: Some(path), text: text.to_owned() };
        assert_eq!(folder.find("arm.toml").unwrap(), expected);
    }
    // Without the source file's name, as some tools leave it, the crate's root comes first.
    assert_eq!(Source::for_macro("arm.toml", None, Some(&folder.0)).unwrap().text, "root");
    assert_eq!(Source::for_build_script("arm.toml", &folder.0).unwrap().text, "root");
}

#[test]
fn tables_outside_of_the_crate_are_shown_as_written() {
    let (folder, other) = (Folder::new("outside"), Folder::new("elsewhere"));
    folder.write("src/arms/arm.toml", "beside");
    folder.write("src/arms/only.toml", "only here");
    other.write("arm.toml", "root");
    // As under trybuild: the source file is in one crate, the manifest in another.
    let file = folder.0.join("src/arms/mod.rs");
    let found = Source::for_macro("arm.toml", Some(&file), Some(&other.0)).unwrap();
    assert_eq!((found.name_shown.as_str(), found.text.as_str()), ("arm.toml", "beside"));
    fs::remove_file(folder.0.join("src/arms/arm.toml")).unwrap();
    let found = Source::for_macro("arm.toml", Some(&file), Some(&other.0)).unwrap();
    assert_eq!((found.name_shown.as_str(), found.text.as_str()), ("arm.toml", "root"));
}

#[test]
fn names_without_an_ending_are_shipped_tables() {
    let folder = Folder::new("shipped");
    folder.write("mycobot", "not this");
    let found = folder.find("mycobot").unwrap();
    assert_eq!((found.name_shown.as_str(), found.path), ("mycobot", None));
    assert_eq!(Some(found.text.as_str()), dh_robots::table("mycobot"));
    let error = folder.find("mycobt").unwrap_err();
    let FindError::NotFound { tried, shipped: true, nearest, .. } = &error else { panic!("{error:?}") };
    assert!(tried.is_empty());
    assert_eq!(nearest.first().map(String::as_str), Some("mycobot"));
    assert!(error.to_string().contains("`mycobt.toml`"), "{error}");
}

#[test]
fn what_is_not_found_lists_the_places_and_similar_names() {
    let folder = Folder::new("missing");
    let error = folder.find("puma561.toml").unwrap_err();
    let text = error.to_string();
    for part in
        ["no file src/arms/puma561.toml, no file puma561.toml, no file robots/puma561.toml", "puma560"]
    {
        assert!(text.contains(part), "{text}");
    }
    assert_eq!(error.diagnostic().code, "missing-file");
    // A folder is no table, however it is called.
    fs::create_dir_all(folder.0.join("arm.toml")).unwrap();
    assert!(matches!(folder.find("arm.toml"), Err(FindError::NotFound { .. })));
}

#[test]
fn the_command_line_takes_files_before_shipped_tables() {
    let folder = Folder::new("command");
    let path = folder.write("ur5", "a file");
    let found = Source::for_command_line(path.to_str().unwrap()).unwrap();
    assert_eq!((found.text.as_str(), found.path.as_deref()), ("a file", Some(path.as_path())));
    assert_eq!(Source::for_command_line("ur5").unwrap().path, None);
    let error = Source::for_command_line("no/such/ur5.toml").unwrap_err().to_string();
    assert!(error.contains("no file no/such/ur5.toml, no shipped table of that name"), "{error}");
    assert!(error.contains("ur5"), "{error}");
}

#[test]
fn files_that_are_no_tables_are_refused() {
    let folder = Folder::new("files");
    folder.write("large.toml", vec![b'#'; MAX_BYTES + 1]);
    folder.write("full.toml", vec![b'#'; MAX_BYTES]);
    folder.write("latin.toml", b"# one\n# \xc3\xa4 gr\xf6\n");
    assert_eq!(folder.find("large.toml"), Err(FindError::TooLarge { name: "large.toml".to_owned() }));
    assert_eq!(folder.find("full.toml").unwrap().text.len(), MAX_BYTES);
    let error = folder.find("latin.toml").unwrap_err();
    assert_eq!(error, FindError::NotUtf8 { name: "latin.toml".to_owned(), line: 2, column: 7 });
    assert_eq!(error.diagnostic().code, "not-utf8");
    assert!(matches!(folder.find("nul\0.toml"), Err(FindError::Unreadable { .. })));
}

const TABLE: &str = r#"
[robot]
name = "two links"
convention = "standard"

[[joint]]
a = 0.3

[[joint]]
a = 0.2
alpha = 1.5708
"#;

#[test]
fn build_scripts_write_the_code_and_tell_cargo() {
    let folder = Folder::new("script");
    let table = folder.write("robots/arm.toml", TABLE);
    let mut told = Vec::new();
    let build = Build::new().table("arm.toml").struct_name("Arm").types(Types::Plain).scalar(ScalarType::F32);
    let file = build.run(&folder.0, &folder.0, |line| told.push(line.to_owned())).unwrap();
    assert_eq!(file, folder.0.join("arm.rs"));
    let code = fs::read_to_string(file).unwrap();
    for part in ["robots/arm.toml", "pub struct Arm;", "pub fn fk(&self, q: &[f32; 2])"] {
        assert!(code.contains(part), "{part} in\n{code}");
    }
    assert!(!code.contains(folder.0.to_str().unwrap()), "no path of this machine");
    assert_eq!(told[0], format!("cargo::rerun-if-changed={}", table.display()));
    // The rounded twist is warned of, drawn, line by line.
    assert!(
        told.len() > 3 && told.iter().skip(1).all(|line| line.starts_with("cargo::warning=")),
        "{told:?}"
    );
    assert!(told.iter().any(|line| line.contains("robots/arm.toml:11:")), "{told:?}");
}

#[test]
fn build_scripts_fail_with_what_is_drawn() {
    let folder = Folder::new("fails");
    folder.write("arm.toml", TABLE.replace("alpha =", "alhpa ="));
    let error = Build::new().table("arm.toml").run(&folder.0, &folder.0, |_| ()).unwrap_err();
    let BuildError::Table { drawn } = &error else { panic!("{error:?}") };
    assert!(drawn.contains("alhpa") && drawn.contains("arm.toml:11:1"), "{drawn}");
    // Build scripts return or unwrap the error, and both print its `Debug` form.
    assert_eq!(format!("{error:?}"), format!("\n{drawn}"));
    assert!(!folder.0.join("arm.rs").exists());
    let missing = Build::new().table("leg.toml").run(&folder.0, Path::new("."), |_| ()).unwrap_err();
    assert!(missing.to_string().contains("no file leg.toml, no file robots/leg.toml"), "{missing}");
}
