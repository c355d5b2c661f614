//! The browser's side of files: the inputs for choosing them, dropping, pasting, and downloads.

use js_sys::{Array, Function, Promise, Reflect, Uint8Array};
use motionscope_core::base::Error;
use wasm_bindgen::closure::Closure;
use wasm_bindgen::{JsCast as _, JsValue};
use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_sys::{
    Blob, BlobPropertyBag, ClipboardEvent, Document, DragEvent, Event, EventTarget, File, FileList,
    FileSystemDirectoryEntry, FileSystemEntry, FileSystemFileEntry, HtmlAnchorElement, HtmlInputElement, Url,
};

use super::given::{self, Arrival, GivenFile};

/// The ids of the inputs that open the browser's dialogs for files and for a folder.
const FILES: &str = "motionscope-files";
const FOLDER: &str = "motionscope-folder";
/// The most files that are taken of a folder.
const MOST_FILES: usize = 20_000;
/// How long the browser has to begin a download, in milliseconds.
const DOWNLOAD_MS: i32 = 60_000;

/// A file and its name with the folders around it.
type Named = (String, File);

/// Takes the files that the user gives to the page, from now on; `wake` is called when some have arrived.
///
/// # Errors
/// If the page has no body.
pub fn listen(wake: impl Fn() + Clone + 'static) -> Result<(), JsValue> {
    let document = document().ok_or(JsValue::NULL)?;
    for (id, is_folder) in [(FILES, false), (FOLDER, true)] {
        add_input(&document, id, is_folder, wake.clone())?;
    }
    let dropped = wake.clone();
    on(&document, "drop", move |event: DragEvent| take_dropped(&event, dropped.clone()))?;
    on(&document, "paste", move |event: ClipboardEvent| take_pasted(&event, wake.clone()))
}

/// Opens the browser's dialog for files, or for a folder.
pub fn choose(is_folder: bool) {
    let id = if is_folder { FOLDER } else { FILES };
    let input = document().and_then(|document| document.get_element_by_id(id));
    if let Some(input) = input.and_then(|input| input.dyn_into::<HtmlInputElement>().ok()) {
        input.click();
    }
}

/// Has the browser download `bytes` as a file called `name`.
///
/// # Errors
/// If it has no room for them.
pub(super) fn download(name: &str, bytes: &[u8]) -> Result<(), Error> {
    offer(name, bytes)
        .map_err(|_| Error::new(format!("the browser does not take {name}; allow downloads, or save less")))
}

fn offer(name: &str, bytes: &[u8]) -> Result<(), JsValue> {
    let window = web_sys::window().ok_or(JsValue::NULL)?;
    let document = window.document().ok_or(JsValue::NULL)?;
    let options = BlobPropertyBag::new();
    options.set_type(media_type(name));
    let blob = Blob::new_with_u8_array_sequence_and_options(&Array::of1(&Uint8Array::from(bytes)), &options)?;
    let url = Url::create_object_url_with_blob(&blob)?;
    let link: HtmlAnchorElement = document.create_element("a")?.dyn_into()?;
    link.set_href(&url);
    link.set_download(name);
    link.click();
    // The browser reads the bytes later.
    let forget = Closure::once_into_js(move || Url::revoke_object_url(&url));
    window.set_timeout_with_callback_and_timeout_and_arguments_0(forget.unchecked_ref(), DOWNLOAD_MS)?;
    Ok(())
}

fn media_type(name: &str) -> &'static str {
    match name.rsplit('.').next().unwrap_or_default() {
        "png" => "image/png",
        "svg" => "image/svg+xml",
        "gif" => "image/gif",
        "webp" => "image/webp",
        "mp4" => "video/mp4",
        "pdf" => "application/pdf",
        "csv" => "text/csv",
        "json" => "application/json",
        "zip" => "application/zip",
        _ => "application/octet-stream",
    }
}

fn document() -> Option<Document> {
    web_sys::window()?.document()
}

/// Has `act` called with each event of this type, before the canvas has it.
fn on<E: wasm_bindgen::JsCast + 'static>(
    target: &EventTarget,
    name: &str,
    act: impl Fn(E) + 'static,
) -> Result<(), JsValue> {
    let heard = Closure::<dyn Fn(Event)>::new(move |event: Event| act(event.unchecked_into()));
    let added = target.add_event_listener_with_callback_and_bool(name, heard.as_ref().unchecked_ref(), true);
    // As long as the page is open.
    heard.forget();
    added
}

fn add_input(document: &Document, id: &str, is_folder: bool, wake: impl Fn() + Clone + 'static) -> Result<(), JsValue> {
    let input: HtmlInputElement = document.create_element("input")?.dyn_into()?;
    input.set_id(id);
    input.set_type("file");
    input.set_multiple(true);
    input.set_webkitdirectory(is_folder);
    input.set_attribute("hidden", "")?;
    document.body().ok_or(JsValue::NULL)?.append_child(&input)?;
    let chosen = input.clone();
    on(&input, "change", move |_: Event| {
        let files = chosen.files().map(|files| named(&files)).unwrap_or_default();
        // The same files can be chosen again.
        chosen.set_value("");
        take(async move { Ok(files) }, true, wake.clone());
    })
}

/// The files of a list.
fn named(files: &FileList) -> Vec<Named> {
    let all = (0..files.length()).filter_map(|index| files.get(index));
    let with_folders = |file: &File| {
        let path = Reflect::get(file, &"webkitRelativePath".into()).ok()?.as_string()?;
        Some(path).filter(|path| !path.is_empty())
    };
    all.map(|file| (with_folders(&file).unwrap_or_else(|| file.name()), file)).collect()
}

fn take_dropped(event: &DragEvent, wake: impl Fn() + 'static) {
    let Some(data) = event.data_transfer() else { return };
    let items = data.items();
    // They are gone once this call has returned.
    let entries: Vec<FileSystemEntry> =
        (0..items.length()).filter_map(|index| items.get(index)?.webkit_get_as_entry().ok().flatten()).collect();
    if entries.is_empty() {
        return;
    }
    event.prevent_default();
    event.stop_immediate_propagation();
    // The window no longer shows where files can be dropped.
    if let (Some(target), Ok(leave)) = (event.target(), DragEvent::new("dragleave")) {
        target.dispatch_event(&leave).unwrap_or_default();
    }
    take(files_in(entries), false, wake);
}

fn take_pasted(event: &ClipboardEvent, wake: impl Fn() + 'static) {
    let files = event.clipboard_data().and_then(|data| data.files()).map(|files| named(&files)).unwrap_or_default();
    if files.is_empty() {
        return;
    }
    event.prevent_default();
    event.stop_immediate_propagation();
    take(async move { Ok(files) }, false, wake);
}

/// Reads the files that `list` gives, and leaves them for the window.
fn take(list: impl Future<Output = Result<Vec<Named>, Error>> + 'static, is_chosen: bool, wake: impl Fn() + 'static) {
    spawn_local(async move {
        let files = match list.await {
            Ok(list) => read(list).await,
            Err(error) => Err(error),
        };
        given::arrive(Arrival { files, is_chosen });
        wake();
    });
}

async fn read(files: Vec<Named>) -> Result<Vec<GivenFile>, Error> {
    given::check_room(files.iter().map(|(_, file)| file.size() as u64).sum())?;
    let mut read = Vec::new();
    for (name, file) in files {
        let unread = |_| Error::new(format!("the browser cannot read {name}; give it again"));
        let content = Uint8Array::new(&JsFuture::from(file.array_buffer()).await.map_err(unread)?);
        let mut bytes = Vec::new();
        let full =
            |_| Error::new(format!("the browser has no memory left for {name}; close other pages, or give less"));
        bytes.try_reserve_exact(content.length() as usize).map_err(full)?;
        bytes.resize(content.length() as usize, 0);
        content.copy_to(&mut bytes);
        read.push(GivenFile { name, bytes: bytes.into() });
    }
    Ok(read)
}

/// All files among `entries` and in their folders.
async fn files_in(mut entries: Vec<FileSystemEntry>) -> Result<Vec<Named>, Error> {
    let mut files = Vec::new();
    while let Some(entry) = entries.pop() {
        let name = entry.full_path().trim_start_matches('/').to_owned();
        let unread = |_| Error::new(format!("the browser cannot read {name}; give it again"));
        if let Some(entry) = entry.is_file().then(|| entry.unchecked_ref::<FileSystemFileEntry>()) {
            let file = answer(|resolve, reject| entry.file_with_callback_and_callback(resolve, reject));
            files.push((name.clone(), file.await.map_err(unread)?.unchecked_into()));
        } else {
            let reader = entry.unchecked_ref::<FileSystemDirectoryEntry>().create_reader();
            // A browser lists a folder piece by piece, up to an empty one.
            loop {
                let piece = answer(|resolve, reject| {
                    reader.read_entries_with_callback_and_callback(resolve, reject).unwrap_or_default();
                });
                let piece: Array = piece.await.map_err(unread)?.unchecked_into();
                if piece.length() == 0 {
                    break;
                }
                entries.extend(piece.iter().map(|entry| entry.unchecked_into::<FileSystemEntry>()));
            }
        }
        if files.len() + entries.len() > MOST_FILES {
            return Err(Error::new(format!("the folder has more than {MOST_FILES} files; give a part of it")));
        }
    }
    Ok(files)
}

/// The answer of a function of the browser that takes two callbacks.
async fn answer(mut ask: impl FnMut(&Function, &Function)) -> Result<JsValue, JsValue> {
    JsFuture::from(Promise::new(&mut |resolve, reject| ask(&resolve, &reject))).await
}
