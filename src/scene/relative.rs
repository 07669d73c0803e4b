//! Names of files relative to a folder, and where names lead.

use std::path::{Component, Path, PathBuf};

/// How a scene in `folder` names `target`: relative if that is possible, with `/` between names.
pub(crate) fn relative(target: &Path, folder: &Path) -> Option<String> {
    let (target, folder) = (resolved(target), resolved(folder));
    let mut names = target.components().peekable();
    let mut folders = folder.components().peekable();
    let mut shared = 0;
    while names.peek().is_some() && names.peek() == folders.peek() {
        names.next();
        folders.next();
        shared += 1;
    }
    if shared == 0 {
        return target.to_str().map(str::to_owned);
    }
    let up = folders.map(|_| Some(".."));
    let down = names.map(|name| name.as_os_str().to_str());
    up.chain(down).collect::<Option<Vec<&str>>>().map(|names| names.join("/"))
}

/// Absolute, with the links of what exists followed and without `.` and `..`.
pub(crate) fn resolved(path: &Path) -> PathBuf {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let mut done = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                done.pop();
            }
            Component::CurDir => {}
            part => done.push(part),
        }
        // step by step, because `..` after a link leaves the folder that it leads to
        if let Ok(real) = done.canonicalize() {
            done = real;
        }
    }
    done
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_lead_from_any_folder_to_the_same_file() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        std::fs::create_dir_all(root.join("a/b")).unwrap();
        std::fs::create_dir_all(root.join("c")).unwrap();
        std::fs::write(root.join("a/m.obj"), "").unwrap();
        let to = |target: &str, from: &str| relative(&root.join(target), &root.join(from)).unwrap();
        assert_eq!(to("a/m.obj", "a"), "m.obj");
        assert_eq!(to("a/m.obj", "a/b"), "../m.obj");
        assert_eq!(to("a/b/../m.obj", "c"), "../a/m.obj");
        assert_eq!(to("a/not/there.obj", "c"), "../a/not/there.obj");
    }

    #[cfg(unix)]
    #[test]
    fn links_do_not_lead_astray() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        std::fs::create_dir_all(root.join("far/deep")).unwrap();
        std::os::unix::fs::symlink(root.join("far/deep"), root.join("link")).unwrap();
        std::fs::write(root.join("far/m.obj"), "").unwrap();
        // `link/..` is `far`
        assert_eq!(relative(&root.join("link/../m.obj"), root).unwrap(), "far/m.obj");
        assert_eq!(relative(&root.join("far/m.obj"), &root.join("link")).unwrap(), "../m.obj");
        assert!(root.join("link/../m.obj").exists());
    }
}
