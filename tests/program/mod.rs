//! The program as a user meets it: messages, files, folders and documents.

mod caveats;
mod command_line;
mod digits;
mod documents;
mod init;
mod lists;
mod long_work;
mod names;
mod one_answer;
mod paper;
mod printed;
mod proposals;
mod public_api;
mod readme;
mod recipes;
mod results_folder;
mod robustness;
mod run_input;
mod summaries;
mod worked;
