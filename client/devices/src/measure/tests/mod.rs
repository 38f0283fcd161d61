mod device;
mod figures;
mod paced;
mod person;
mod refusals;
