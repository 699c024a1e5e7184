/** The end of the upload dialog: progress and remaining time of the computation, which can be ended here. */

import { JobProgress } from "../progress/jobProgress";
import { faultOf } from "../progress/progressCards";
import { isActive, type TreeChange } from "../server/api";
import { make } from "../ui/dom";

export interface ComputingTools {
  cancel(): void;
  /** The computation goes on; the dialog closes. */
  leave(): void;
}

export class Computing {
  readonly root = make("div", "", "own-tree-computing");
  private readonly job: JobProgress;
  private readonly cancel = make("button", "Cancel");
  private readonly leave = make("button", "Continue in the forest", "primary");

  constructor(name: string, tools: ComputingTools) {
    this.job = new JobProgress(name);
    this.job.line.setAttribute("role", "status");
    const heading = make("p", "Computing its motion ");
    heading.append(this.job.percent);
    const foot = make("footer");
    foot.append(this.cancel, this.leave);
    for (const button of [this.cancel, this.leave]) button.type = "button";
    this.cancel.addEventListener("click", () => {
      this.cancel.disabled = true;
      tools.cancel();
    });
    this.leave.addEventListener("click", () => tools.leave());
    const hint = make(
      "p",
      "The tree starts with a simple motion. This window then closes and shows it.",
      "soft",
    );
    this.root.append(heading, this.job.bar.root, this.job.line, hint, foot);
  }

  focus(): void {
    this.leave.focus();
  }

  update({ job }: TreeChange): void {
    if (job?.state === "failed") {
      this.job.end(faultOf(job));
      this.cancel.hidden = true;
      this.leave.textContent = "Close";
    } else if (isActive(job)) this.job.show(job);
  }

  dispose(): void {
    this.job.end("");
  }
}
