//! A server of files on this machine, for trying and testing a page.

use std::fs;
use std::io::{BufRead as _, BufReader, Write as _};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use anyhow::{Context as _, Result, ensure};

/// A server of one folder.
#[derive(Debug)]
pub struct Server {
    port: u16,
    base: String,
    is_stopping: Arc<AtomicBool>,
    thread: JoinHandle<()>,
}

/// The folder, and the path below which it is served.
struct Site {
    folder: PathBuf,
    base: String,
}

impl Server {
    /// Serves a folder below the path `base`, which begins and ends with a slash. Port 0 takes a free one.
    ///
    /// # Errors
    /// If no page was built there, or the port is taken.
    pub fn start(folder: PathBuf, base: &str, port: u16) -> Result<Self> {
        let has_page = folder.join("index.html").exists();
        ensure!(has_page, "there is no page in {}; run `cargo xtask web` first", folder.display());
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port));
        let listener = listener.with_context(|| format!("port {port} is taken; choose another one with --port"))?;
        let port = listener.local_addr()?.port();
        let site = Arc::new(Site { folder, base: base.to_owned() });
        let is_stopping = Arc::new(AtomicBool::new(false));
        let stops = Arc::clone(&is_stopping);
        let thread = std::thread::spawn(move || {
            for stream in listener.incoming().take_while(|_| !stops.load(Ordering::Acquire)).flatten() {
                let site = Arc::clone(&site);
                // A browser may break a connection off at any time.
                std::thread::spawn(move || site.answer(stream).ok());
            }
        });
        Ok(Self { port, base: base.to_owned(), is_stopping, thread })
    }

    /// Where the page is.
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}{}", self.port, self.base)
    }

    /// Serves until the process is ended.
    pub fn wait(self) {
        self.thread.join().ok();
    }

    /// Stops serving: from now on, connections are refused.
    pub fn stop(self) {
        self.is_stopping.store(true, Ordering::Release);
        // The thread waits for a connection before it looks.
        TcpStream::connect((Ipv4Addr::LOCALHOST, self.port)).ok();
        self.thread.join().ok();
    }
}

impl Site {
    fn answer(&self, mut stream: TcpStream) -> std::io::Result<()> {
        let mut lines = BufReader::new(stream.try_clone()?).lines();
        let request = lines.next().transpose()?.unwrap_or_default();
        for line in lines {
            if line?.is_empty() {
                break;
            }
        }
        let mut words = request.split(' ');
        let (method, target) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
        let file = self.file(target).and_then(|path| Some((fs::read(&path).ok()?, media_type(&path))));
        let (status, (body, media_type)) = match file {
            Some(file) => ("200 OK", file),
            None => ("404 Not Found", (b"There is no such file.\n".to_vec(), "text/plain")),
        };
        write!(
            stream,
            "HTTP/1.1 {status}\r\nContent-Type: {media_type}\r\nContent-Length: {}\r\nCache-Control: no-cache\r\n\
             Connection: close\r\n\r\n",
            body.len()
        )?;
        if method != "HEAD" {
            stream.write_all(&body)?;
        }
        stream.flush()
    }

    /// The file of a request, within the folder.
    fn file(&self, target: &str) -> Option<PathBuf> {
        let path = target.split(['?', '#']).next()?.strip_prefix(&self.base)?;
        let path = Path::new(if path.is_empty() { "index.html" } else { path });
        path.components().all(|part| matches!(part, Component::Normal(_))).then(|| self.folder.join(path))
    }
}

fn media_type(path: &Path) -> &'static str {
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript",
        Some("wasm") => "application/wasm",
        Some("svg") => "image/svg+xml",
        Some("webmanifest") => "application/manifest+json",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_of_the_folder_below_the_base_are_served() {
        let site = Site { folder: "site".into(), base: "/course/".into() };
        let file = |target| site.file(target);
        assert_eq!(file("/course/"), Some("site/index.html".into()));
        assert_eq!(file("/course/icon.svg?new"), Some("site/icon.svg".into()));
        assert_eq!([file("/"), file("/course/../secret"), file("/course//etc/passwd"), file("")], [const { None }; 4]);
    }
}
