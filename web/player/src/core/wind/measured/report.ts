/** What was understood of a file; the same names as in Python. */
export interface Report {
  /** What each column was taken for: its name, with the unit. */
  readonly columns: Readonly<Record<string, string>>;
  readonly rows: number;
  readonly missing: number;
  readonly implausible: number;
  readonly duplicates: number;
  readonly disordered: number;
  readonly gaps: number;
  readonly longest_gap_s: number;
  readonly rate_hz: number;
  readonly duration_s: number;
  readonly used_rate_hz: number;
  /** First used sample, from the first one of the file. */
  readonly used_start_s: number;
  readonly used_s: number;
  /** Period of the wind. */
  readonly loop_s: number;
  readonly mean_speed_m_s: number;
  readonly max_speed_m_s: number;
  /** Mean direction that the wind comes from, clockwise from north. */
  readonly from_deg: number;
  /** Standard deviation of the speed over its mean. */
  readonly intensity: number;
  /** Assumptions and faults, as sentences. */
  readonly notes: readonly string[];
}
