// The chart of a patient in the form, with its history.

/** Number of steps that can be undone. */
const STEPS = 200;

export class Patient {
  /** `model`: limits of the server's patients. */
  constructor(model, chart) {
    this.model = model;
    /** Charts of missing teeth, so that a click brings a tooth back. */
    this.lost = new Map();
    this.take(chart);
    this.forget();
  }

  /** Takes a chart that the server has saved. */
  take(chart) {
    this.chart = chart;
    this.saved = this.text();
  }

  /** Forgets all steps. */
  forget() {
    this.done = [];
    this.undone = [];
  }

  text() {
    return JSON.stringify(this.chart);
  }

  isDirty() {
    return this.text() !== this.saved;
  }

  /** Chart of a tooth; undefined for a missing one. */
  tooth(fdi) {
    return this.chart.teeth.find((one) => one.fdi === fdi);
  }

  healthy(fdi) {
    return { ...structuredClone(this.model.healthy), fdi };
  }

  /** All teeth of the model by number; a missing one has its former chart. */
  teeth() {
    const former = (fdi) => this.lost.get(fdi) ?? this.healthy(fdi);
    return new Map(this.model.teeth.map((fdi) => [fdi, this.tooth(fdi) ?? former(fdi)]));
  }

  /** Changes the chart by `act`, in one step of the history. Returns whether the chart has changed. */
  change(act) {
    const before = this.text();
    act(this.chart);
    if (before === this.text()) {
      return false;
    }
    this.done.push(before);
    if (this.done.length > STEPS) {
      this.done.shift();
    }
    this.undone.length = 0;
    return true;
  }

  /** Undoes the last step. Returns whether there was one. */
  undo() {
    return this.step(this.done, this.undone);
  }

  /** Repeats the last step that was undone. Returns whether there was one. */
  redo() {
    return this.step(this.undone, this.done);
  }

  step(from, to) {
    const other = from.pop();
    if (other === undefined) {
      return false;
    }
    to.push(this.text());
    this.chart = JSON.parse(other);
    return true;
  }

  /** Takes a tooth out of the mouth, or brings it back. */
  toggleMissing(fdi) {
    return this.change((chart) => {
      const own = this.tooth(fdi);
      if (own) {
        this.lost.set(fdi, structuredClone(own));
        chart.teeth = chart.teeth.filter((one) => one !== own);
        chart.missing.push(fdi);
      } else {
        chart.missing = chart.missing.filter((one) => one !== fdi);
        chart.teeth.push(structuredClone(this.lost.get(fdi) ?? this.healthy(fdi)));
      }
      const place = (one) => this.model.teeth.indexOf(one.fdi);
      chart.teeth.sort((a, b) => place(a) - place(b));
    });
  }
}
