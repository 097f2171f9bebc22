# Written by tests/program/summaries.rs from the types of src: the keys of results, for type checkers.

from typing import Any, Generic, TypeVar

from ._summary import Summary

_T = TypeVar("_T")

class BySide(Summary, Generic[_T]):
    right: _T
    left: _T

class CapacityKeys:
    capacity: BySide[CapacityCapacity | None]
    masses: str
    warnings: list[str]
    unlikely: list[CapacityUnlikely]
    scenario: dict[str, Any]

class Capacity(Summary, CapacityKeys):
    pass

class CapacityResult:
    @property
    def summary(self) -> Capacity: ...
    capacity: BySide[CapacityCapacity | None]
    masses: str
    warnings: list[str]
    unlikely: list[CapacityUnlikely]
    scenario: dict[str, Any]

class CapacityCapacityKeys:
    control_point_m: list[float]
    acceleration_g: float
    ultimate_displacement_m: float
    oscillator: CapacityCapacityOscillator
    ties: list[CapacityCapacityTies]

class CapacityCapacity(Summary, CapacityCapacityKeys):
    pass

class CapacityCapacityOscillatorKeys:
    participating_mass_kg: float
    mass_fraction: float
    acceleration_g: float
    ultimate_displacement_m: float
    secant_period_s_at_part_of_ultimate: dict[Any, float | None]

class CapacityCapacityOscillator(Summary, CapacityCapacityOscillatorKeys):
    pass

class CapacityCapacityTiesKeys:
    yields_at_m: float | None
    breaks_at_m: float | None

class CapacityCapacityTies(Summary, CapacityCapacityTiesKeys):
    pass

class CapacityUnlikelyKeys:
    key: str
    value: float | None
    unit: str
    likely: str | None

class CapacityUnlikely(Summary, CapacityUnlikelyKeys):
    pass

class EnsembleUncertainMapKeys:
    program: str
    version: str
    scenario: dict[str, Any]
    warnings: list[str]
    unlikely: list[EnsembleUncertainMapUnlikely]
    one_direction: str | None
    samples: int
    answered: int
    invalid: int
    failed: int
    incomplete: int
    outside: int
    outside_model: int | None
    four_link_histories: int
    largest_thrust_excess_ratio: float | None
    friction_demand: float | None
    friction_condition: str | None
    own_without_answer: str | None
    without_answer: list[EnsembleUncertainMapWithoutAnswer]
    not_considered: str
    what_matters: EnsembleUncertainMapWhatMatters
    axes: list[str]
    cells: int
    cells_at_levels: list[int]
    own: EnsembleUncertainMapOwn | None
    crossings: list[EnsembleUncertainMapCrossings]
    histories_without_outcome: EnsembleUncertainMapHistoriesWithoutOutcome
    first_without_outcome: str | None
    part_that_overturns: EnsembleUncertainMapPartThatOverturns

class EnsembleUncertainMap(Summary, EnsembleUncertainMapKeys):
    pass

class EnsembleUncertainMapResult:
    @property
    def summary(self) -> EnsembleUncertainMap: ...
    program: str
    version: str
    scenario: dict[str, Any]
    warnings: list[str]
    unlikely: list[EnsembleUncertainMapUnlikely]
    one_direction: str | None
    samples: int
    answered: int
    invalid: int
    failed: int
    incomplete: int
    outside: int
    outside_model: int | None
    four_link_histories: int
    largest_thrust_excess_ratio: float | None
    friction_demand: float | None
    friction_condition: str | None
    own_without_answer: str | None
    without_answer: list[EnsembleUncertainMapWithoutAnswer]
    not_considered: str
    what_matters: EnsembleUncertainMapWhatMatters
    cells: int
    cells_at_levels: list[int]
    own: EnsembleUncertainMapOwn | None
    crossings: list[EnsembleUncertainMapCrossings]
    histories_without_outcome: EnsembleUncertainMapHistoriesWithoutOutcome
    first_without_outcome: str | None
    part_that_overturns: EnsembleUncertainMapPartThatOverturns

class EnsembleUncertainMapUnlikelyKeys:
    key: str
    value: float | None
    unit: str
    likely: str | None

class EnsembleUncertainMapUnlikely(Summary, EnsembleUncertainMapUnlikelyKeys):
    pass

class EnsembleUncertainMapWithoutAnswerKeys:
    sample: int
    why: str
    reason: str

class EnsembleUncertainMapWithoutAnswer(Summary, EnsembleUncertainMapWithoutAnswerKeys):
    pass

class EnsembleUncertainMapWhatMattersKeys:
    key: str
    first_order: float
    first_order_interval: list[float]
    rank_correlation: float
    rank_correlation_interval: list[float]
    total: float
    total_interval: list[float]

class EnsembleUncertainMapWhatMatters(Summary, EnsembleUncertainMapWhatMattersKeys):
    pass

class EnsembleUncertainMapOwnKeys:
    overturned: int
    survived_in_doubt: int

class EnsembleUncertainMapOwn(Summary, EnsembleUncertainMapOwnKeys):
    pass

class EnsembleUncertainMapCrossingsKeys:
    x: float
    y: list[float | None]
    above: list[float | None]
    at_most: list[bool]

class EnsembleUncertainMapCrossings(Summary, EnsembleUncertainMapCrossingsKeys):
    pass

class EnsembleUncertainMapHistoriesWithoutOutcomeKeys:
    invalid: int
    failed: int
    incomplete: int
    outside: int

class EnsembleUncertainMapHistoriesWithoutOutcome(Summary, EnsembleUncertainMapHistoriesWithoutOutcomeKeys):
    pass

class EnsembleUncertainMapPartThatOverturnsKeys:
    quantile_05: float | None
    median: float | None
    quantile_95: float | None

class EnsembleUncertainMapPartThatOverturns(Summary, EnsembleUncertainMapPartThatOverturnsKeys):
    pass

class EnsembleUncertainRunKeys:
    program: str
    version: str
    scenario: dict[str, Any]
    warnings: list[str]
    unlikely: list[EnsembleUncertainRunUnlikely]
    one_direction: str | None
    samples: int
    answered: int
    invalid: int
    failed: int
    incomplete: int
    outside: int
    outside_model: int | None
    four_link_histories: int
    largest_thrust_excess_ratio: float | None
    friction_demand: float | None
    friction_condition: str | None
    own_without_answer: str | None
    without_answer: list[EnsembleUncertainRunWithoutAnswer]
    not_considered: str
    what_matters: EnsembleUncertainRunWhatMatters
    own: EnsembleUncertainRunOwn | None
    outcomes: dict[Any, EnsembleUncertainRunOutcomes]
    peak_rotation_rad: EnsembleUncertainRunPeakRotationRad
    followed_body: int

class EnsembleUncertainRun(Summary, EnsembleUncertainRunKeys):
    pass

class EnsembleUncertainRunResult:
    @property
    def summary(self) -> EnsembleUncertainRun: ...
    program: str
    version: str
    scenario: dict[str, Any]
    warnings: list[str]
    unlikely: list[EnsembleUncertainRunUnlikely]
    one_direction: str | None
    samples: int
    answered: int
    invalid: int
    failed: int
    incomplete: int
    outside: int
    outside_model: int | None
    four_link_histories: int
    largest_thrust_excess_ratio: float | None
    friction_demand: float | None
    friction_condition: str | None
    own_without_answer: str | None
    without_answer: list[EnsembleUncertainRunWithoutAnswer]
    not_considered: str
    what_matters: EnsembleUncertainRunWhatMatters
    own: EnsembleUncertainRunOwn | None
    outcomes: dict[Any, EnsembleUncertainRunOutcomes]
    peak_rotation_rad: EnsembleUncertainRunPeakRotationRad
    followed_body: int

class EnsembleUncertainRunUnlikelyKeys:
    key: str
    value: float | None
    unit: str
    likely: str | None

class EnsembleUncertainRunUnlikely(Summary, EnsembleUncertainRunUnlikelyKeys):
    pass

class EnsembleUncertainRunWithoutAnswerKeys:
    sample: int
    why: str
    reason: str

class EnsembleUncertainRunWithoutAnswer(Summary, EnsembleUncertainRunWithoutAnswerKeys):
    pass

class EnsembleUncertainRunWhatMattersKeys:
    key: str
    first_order: float
    first_order_interval: list[float]
    rank_correlation: float
    rank_correlation_interval: list[float]
    total: float
    total_interval: list[float]

class EnsembleUncertainRunWhatMatters(Summary, EnsembleUncertainRunWhatMattersKeys):
    pass

class EnsembleUncertainRunOwnKeys:
    verdict: str
    overturning_share: float
    peak_rotation_over_critical: float | None
    peak_potential_over_barrier: float | None

class EnsembleUncertainRunOwn(Summary, EnsembleUncertainRunOwnKeys):
    pass

class EnsembleUncertainRunOutcomesKeys:
    count: int
    uncertain: int
    no_verdict: int
    of: int
    share: float
    low: float
    high: float

class EnsembleUncertainRunOutcomes(Summary, EnsembleUncertainRunOutcomesKeys):
    pass

class EnsembleUncertainRunPeakRotationRadKeys:
    quantile_05: float | None
    median: float | None
    quantile_95: float | None

class EnsembleUncertainRunPeakRotationRad(Summary, EnsembleUncertainRunPeakRotationRadKeys):
    pass

class EnsembleUncertainSuiteKeys:
    program: str
    version: str
    scenario: dict[str, Any]
    warnings: list[str]
    unlikely: list[EnsembleUncertainSuiteUnlikely]
    one_direction: str | None
    samples: int
    answered: int
    invalid: int
    failed: int
    incomplete: int
    outside: int
    outside_model: int | None
    four_link_histories: int
    largest_thrust_excess_ratio: float | None
    friction_demand: float | None
    friction_condition: str | None
    own_without_answer: str | None
    without_answer: list[EnsembleUncertainSuiteWithoutAnswer]
    not_considered: str
    what_matters: EnsembleUncertainSuiteWhatMatters
    intensity: str
    to_quote: str | None
    quote: str
    first_intensity: EnsembleUncertainSuiteFirstIntensity
    own_first_intensity: EnsembleUncertainSuiteFirstIntensity
    fragility: EnsembleUncertainSuiteFragility
    records: int
    edges: int
    at_lowest_level: int

class EnsembleUncertainSuite(Summary, EnsembleUncertainSuiteKeys):
    pass

class EnsembleUncertainSuiteResult:
    @property
    def summary(self) -> EnsembleUncertainSuite: ...
    program: str
    version: str
    scenario: dict[str, Any]
    warnings: list[str]
    unlikely: list[EnsembleUncertainSuiteUnlikely]
    one_direction: str | None
    samples: int
    answered: int
    invalid: int
    failed: int
    incomplete: int
    outside: int
    outside_model: int | None
    four_link_histories: int
    largest_thrust_excess_ratio: float | None
    friction_demand: float | None
    friction_condition: str | None
    own_without_answer: str | None
    without_answer: list[EnsembleUncertainSuiteWithoutAnswer]
    not_considered: str
    what_matters: EnsembleUncertainSuiteWhatMatters
    intensity: str
    to_quote: str | None
    quote: str
    first_intensity: EnsembleUncertainSuiteFirstIntensity
    own_first_intensity: EnsembleUncertainSuiteFirstIntensity
    records: int
    edges: int
    at_lowest_level: int

class EnsembleUncertainSuiteUnlikelyKeys:
    key: str
    value: float | None
    unit: str
    likely: str | None

class EnsembleUncertainSuiteUnlikely(Summary, EnsembleUncertainSuiteUnlikelyKeys):
    pass

class EnsembleUncertainSuiteWithoutAnswerKeys:
    sample: int
    why: str
    reason: str

class EnsembleUncertainSuiteWithoutAnswer(Summary, EnsembleUncertainSuiteWithoutAnswerKeys):
    pass

class EnsembleUncertainSuiteWhatMattersKeys:
    key: str
    first_order: float
    first_order_interval: list[float]
    rank_correlation: float
    rank_correlation_interval: list[float]
    total: float
    total_interval: list[float]

class EnsembleUncertainSuiteWhatMatters(Summary, EnsembleUncertainSuiteWhatMattersKeys):
    pass

class EnsembleUncertainSuiteFirstIntensityKeys:
    quantile_05: float | None
    median: float | None
    quantile_95: float | None
    at_most: list[bool]

class EnsembleUncertainSuiteFirstIntensity(Summary, EnsembleUncertainSuiteFirstIntensityKeys):
    pass

class EnsembleUncertainSuiteFragilityKeys:
    record_to_record: EnsembleUncertainSuiteFragilityRecordToRecord
    uncertain_data: EnsembleUncertainSuiteFragilityRecordToRecord
    both: EnsembleUncertainSuiteFragilityRecordToRecord

class EnsembleUncertainSuiteFragility(Summary, EnsembleUncertainSuiteFragilityKeys):
    pass

class EnsembleUncertainSuiteFragilityRecordToRecordKeys:
    median: float | None
    median_interval: list[float] | None
    dispersion: float | None
    dispersion_interval: list[float] | None

class EnsembleUncertainSuiteFragilityRecordToRecord(Summary, EnsembleUncertainSuiteFragilityRecordToRecordKeys):
    pass

class EnsembleUncertainThresholdKeys:
    program: str
    version: str
    scenario: dict[str, Any]
    warnings: list[str]
    unlikely: list[EnsembleUncertainThresholdUnlikely]
    one_direction: str | None
    samples: int
    answered: int
    invalid: int
    failed: int
    incomplete: int
    outside: int
    outside_model: int | None
    four_link_histories: int
    largest_thrust_excess_ratio: float | None
    friction_demand: float | None
    friction_condition: str | None
    own_without_answer: str | None
    without_answer: list[EnsembleUncertainThresholdWithoutAnswer]
    not_considered: str
    what_matters: EnsembleUncertainThresholdWhatMatters
    to_quote: str | None
    counted: int
    rank_of_limit: int | None
    lower_limit_factor: float | None
    survives_up_to_factor: EnsembleUncertainThresholdSurvivesUpToFactor
    own_survives_up_to_factor: float | None
    first_factor: EnsembleUncertainThresholdFirstFactor
    at_smallest_factor: int
    beyond_largest_factor: int
    tried_to_factor: float | None
    own_first_factor: float | None
    own_first_factor_at_most: bool
    overturned_up_to_factor_1: EnsembleUncertainThresholdOverturnedUpToFactor1 | None

class EnsembleUncertainThreshold(Summary, EnsembleUncertainThresholdKeys):
    pass

class EnsembleUncertainThresholdResult:
    @property
    def summary(self) -> EnsembleUncertainThreshold: ...
    program: str
    version: str
    scenario: dict[str, Any]
    warnings: list[str]
    unlikely: list[EnsembleUncertainThresholdUnlikely]
    one_direction: str | None
    samples: int
    answered: int
    invalid: int
    failed: int
    incomplete: int
    outside: int
    outside_model: int | None
    four_link_histories: int
    largest_thrust_excess_ratio: float | None
    friction_demand: float | None
    friction_condition: str | None
    own_without_answer: str | None
    without_answer: list[EnsembleUncertainThresholdWithoutAnswer]
    not_considered: str
    what_matters: EnsembleUncertainThresholdWhatMatters
    to_quote: str | None
    counted: int
    rank_of_limit: int | None
    lower_limit_factor: float | None
    survives_up_to_factor: EnsembleUncertainThresholdSurvivesUpToFactor
    own_survives_up_to_factor: float | None
    at_smallest_factor: int
    beyond_largest_factor: int
    tried_to_factor: float | None
    own_first_factor: float | None
    own_first_factor_at_most: bool
    overturned_up_to_factor_1: EnsembleUncertainThresholdOverturnedUpToFactor1 | None

class EnsembleUncertainThresholdUnlikelyKeys:
    key: str
    value: float | None
    unit: str
    likely: str | None

class EnsembleUncertainThresholdUnlikely(Summary, EnsembleUncertainThresholdUnlikelyKeys):
    pass

class EnsembleUncertainThresholdWithoutAnswerKeys:
    sample: int
    why: str
    reason: str

class EnsembleUncertainThresholdWithoutAnswer(Summary, EnsembleUncertainThresholdWithoutAnswerKeys):
    pass

class EnsembleUncertainThresholdWhatMattersKeys:
    key: str
    first_order: float
    first_order_interval: list[float]
    rank_correlation: float
    rank_correlation_interval: list[float]
    total: float
    total_interval: list[float]

class EnsembleUncertainThresholdWhatMatters(Summary, EnsembleUncertainThresholdWhatMattersKeys):
    pass

class EnsembleUncertainThresholdSurvivesUpToFactorKeys:
    quantile_05: float | None
    median: float | None
    quantile_95: float | None

class EnsembleUncertainThresholdSurvivesUpToFactor(Summary, EnsembleUncertainThresholdSurvivesUpToFactorKeys):
    pass

class EnsembleUncertainThresholdFirstFactorKeys:
    quantile_05: float | None
    median: float | None
    quantile_95: float | None
    at_most: list[bool]

class EnsembleUncertainThresholdFirstFactor(Summary, EnsembleUncertainThresholdFirstFactorKeys):
    pass

class EnsembleUncertainThresholdOverturnedUpToFactor1Keys:
    count: int
    uncertain: int
    no_verdict: int
    of: int
    share: float
    low: float
    high: float

class EnsembleUncertainThresholdOverturnedUpToFactor1(Summary, EnsembleUncertainThresholdOverturnedUpToFactor1Keys):
    pass

class ImpactKeys:
    impacts: list[ImpactImpacts]
    impacts_after_left: list[ImpactImpacts] | None
    models: list[ImpactModels] | None
    certificate: ImpactCertificate | None
    warnings: list[str]
    unlikely: list[ImpactUnlikely]
    starts: list[ImpactImpactsBefore]
    count: int
    chosen: str | None
    model: str
    restitution_factor: float

class Impact(Summary, ImpactKeys):
    pass

class ImpactResult:
    @property
    def summary(self) -> Impact: ...
    impacts_after_left: list[ImpactImpacts] | None
    models: list[ImpactModels] | None
    certificate: ImpactCertificate | None
    warnings: list[str]
    unlikely: list[ImpactUnlikely]
    starts: list[ImpactImpactsBefore]
    count: int
    chosen: str | None
    model: str
    restitution_factor: float

class ImpactImpactsKeys:
    index: int
    restitution: float
    before: ImpactImpactsBefore
    after: ImpactImpactsBefore
    impulses: list[ImpactImpactsImpulses] | None
    impulse_line: ImpactImpactsImpulseLine | None

class ImpactImpacts(Summary, ImpactImpactsKeys):
    pass

class ImpactImpactsBeforeKeys:
    sway: str
    hinges: list[ImpactImpactsBeforeHinges]

class ImpactImpactsBefore(Summary, ImpactImpactsBeforeKeys):
    pass

class ImpactImpactsBeforeHingesKeys:
    angle_deg: float
    edge: str | None
    joint: int
    height_m: float
    side: str

class ImpactImpactsBeforeHinges(Summary, ImpactImpactsBeforeHingesKeys):
    pass

class ImpactImpactsImpulsesKeys:
    hinge: str
    x_n_s_per_m: float
    y_n_s_per_m: float

class ImpactImpactsImpulses(Summary, ImpactImpactsImpulsesKeys):
    pass

class ImpactImpactsImpulseLineKeys:
    admissible: bool
    largest_eccentricity_ratio: float | None
    largest_eccentricity_joint: int | None
    largest_eccentricity_angle_deg: float | None
    least_normal_n_s_per_m: float | None
    least_normal_joint: int | None
    least_normal_angle_deg: float | None
    largest_tangential_ratio: float | None
    largest_tangential_joint: int | None
    largest_tangential_angle_deg: float | None

class ImpactImpactsImpulseLine(Summary, ImpactImpactsImpulseLineKeys):
    pass

class ImpactModelsKeys:
    model: str
    impact: ImpactModelsImpact | None

class ImpactModels(Summary, ImpactModelsKeys):
    pass

class ImpactModelsImpactKeys:
    restitution: float
    after: ImpactImpactsBefore
    impulses: list[ImpactImpactsImpulses] | None
    impulse_line: ImpactImpactsImpulseLine | None

class ImpactModelsImpact(Summary, ImpactModelsImpactKeys):
    pass

class ImpactCertificateKeys:
    index: int
    joints: int
    restitution_four_link: float
    restitution_all_fields: float
    gap: float
    impulse_line_admissible: bool | None
    opened_joints: list[ImpactCertificateOpenedJoints]
    impulse_line: ImpactImpactsImpulseLine | None
    zones: list[ImpactCertificateZones]

class ImpactCertificate(Summary, ImpactCertificateKeys):
    pass

class ImpactCertificateOpenedJointsKeys:
    joint: int | None
    angle_deg: float | None
    edge: str
    opening_rate_ratio: float

class ImpactCertificateOpenedJoints(Summary, ImpactCertificateOpenedJointsKeys):
    pass

class ImpactCertificateZonesKeys:
    edge: str
    to: ImpactCertificateZonesFrom
    opening_rate_ratio: float

class ImpactCertificateZones(Summary, ImpactCertificateZonesKeys):
    pass

class ImpactCertificateZonesFromKeys:
    joint: int | None
    angle_deg: float | None

class ImpactCertificateZonesFrom(Summary, ImpactCertificateZonesFromKeys):
    pass

class ImpactUnlikelyKeys:
    key: str
    value: float | None
    unit: str
    likely: str | None

class ImpactUnlikely(Summary, ImpactUnlikelyKeys):
    pass

class LimitKeys:
    incipient_acceleration_g: BySide[float | None]
    incipient_acceleration_m_s2: BySide[float | None]
    no_push_because: str | None
    mechanism: BySide[list[LimitMechanism]]
    friction_demand: BySide[float | None]
    unstable_rotations: dict[Any, float] | None
    equivalent_block: LimitEquivalentBlock | None
    to_the_left: LimitToTheLeft | None
    capacity_g: BySide[float | None] | None
    capacity_not_found: BySide[str | None] | None
    wall_behind: str | None
    hinges: list[LimitHinges] | None
    ties: LimitTies | None
    top_reaction_n: BySide[float] | None
    four_links: LimitFourLinks | None
    friction: LimitFriction | None
    live: LimitLive | None
    warnings: list[str]
    unlikely: list[LimitUnlikely]
    bodies: list[str]
    tie_places: list[str]

class Limit(Summary, LimitKeys):
    pass

class LimitResult:
    @property
    def summary(self) -> Limit: ...
    incipient_acceleration_g: BySide[float | None]
    incipient_acceleration_m_s2: BySide[float | None]
    no_push_because: str | None
    mechanism: BySide[list[LimitMechanism]]
    friction_demand: BySide[float | None]
    unstable_rotations: dict[Any, float] | None
    equivalent_block: LimitEquivalentBlock | None
    to_the_left: LimitToTheLeft | None
    capacity_g: BySide[float | None] | None
    capacity_not_found: BySide[str | None] | None
    wall_behind: str | None
    hinges: list[LimitHinges] | None
    ties: LimitTies | None
    top_reaction_n: BySide[float] | None
    four_links: LimitFourLinks | None
    friction: LimitFriction | None
    live: LimitLive | None
    warnings: list[str]
    unlikely: list[LimitUnlikely]
    bodies: list[str]
    tie_places: list[str]

class LimitMechanismKeys:
    joint: int
    edge: str | None
    x_m: float
    y_m: float
    angle_deg: float
    height_m: float
    side: str

class LimitMechanism(Summary, LimitMechanismKeys):
    pass

class LimitEquivalentBlockKeys:
    slenderness_rad: float
    at_rest: LimitEquivalentBlockAtRest | None
    at_critical: LimitEquivalentBlockAtRest | None

class LimitEquivalentBlock(Summary, LimitEquivalentBlockKeys):
    pass

class LimitEquivalentBlockAtRestKeys:
    p_rad_s: float
    half_diagonal_m: float

class LimitEquivalentBlockAtRest(Summary, LimitEquivalentBlockAtRestKeys):
    pass

class LimitToTheLeftKeys:
    hinges: list[LimitToTheLeftHinges]
    unstable_equilibrium_rad: list[float]
    equivalent_block: LimitEquivalentBlock | None

class LimitToTheLeft(Summary, LimitToTheLeftKeys):
    pass

class LimitToTheLeftHingesKeys:
    angle_deg: float
    edge: str | None
    joint: int
    height_m: float
    side: str

class LimitToTheLeftHinges(Summary, LimitToTheLeftHingesKeys):
    pass

class LimitHingesKeys:
    joint: int
    edge: str

class LimitHinges(Summary, LimitHingesKeys):
    pass

class LimitTiesKeys:
    forces_at_rest_n: list[float]
    stands_without: bool
    without: BySide[float | None]
    yielding: BySide[LimitTiesYielding]
    mechanism_without: bool | None

class LimitTies(Summary, LimitTiesKeys):
    pass

class LimitTiesYieldingKeys:
    incipient_acceleration_g: float | None
    forces_n: list[float] | None
    mechanism: list[LimitMechanism]

class LimitTiesYielding(Summary, LimitTiesYieldingKeys):
    pass

class LimitFourLinksKeys:
    right: LimitFourLinksRight
    left: LimitFourLinksRight
    none_because: str

class LimitFourLinks(Summary, LimitFourLinksKeys):
    pass

class LimitFourLinksRightKeys:
    hinges: list[LimitToTheLeftHinges]
    unstable_equilibrium_rad: list[float]
    equivalent_block: LimitEquivalentBlock | None

class LimitFourLinksRight(Summary, LimitFourLinksRightKeys):
    pass

class LimitFrictionKeys:
    right: LimitFrictionRight
    left: LimitFrictionRight
    coefficient: float
    least_coefficient: float
    incipient_acceleration_g: BySide[float | None]

class LimitFriction(Summary, LimitFrictionKeys):
    pass

class LimitFrictionRightKeys:
    incipient_acceleration_g: float | None
    sliding_governs: bool
    mechanism: list[LimitFrictionRightMechanism] | None

class LimitFrictionRight(Summary, LimitFrictionRightKeys):
    pass

class LimitFrictionRightMechanismKeys:
    joint: int
    opens_intrados: bool
    opens_extrados: bool
    slips_towards: str | None

class LimitFrictionRightMechanism(Summary, LimitFrictionRightMechanismKeys):
    pass

class LimitLiveKeys:
    without_sliding: LimitLiveWithoutSliding
    with_friction: LimitLiveWithoutSliding | None
    positions: list[LimitLivePositions]

class LimitLive(Summary, LimitLiveKeys):
    pass

class LimitLiveWithoutSlidingKeys:
    friction_coefficient: float | None
    multiplier: float | None
    weight_n: float | None
    towards: str | None
    axles: list[LimitLiveWithoutSlidingAxles]
    mechanism: list[LimitFrictionRightMechanism]
    thrust_line_m: list[list[float] | None]

class LimitLiveWithoutSliding(Summary, LimitLiveWithoutSlidingKeys):
    pass

class LimitLiveWithoutSlidingAxlesKeys:
    x_m: float
    on_arch_kg: float

class LimitLiveWithoutSlidingAxles(Summary, LimitLiveWithoutSlidingAxlesKeys):
    pass

class LimitLivePositionsKeys:
    towards: str
    x_m: float
    multiplier: float | None
    multiplier_with_friction: float | None

class LimitLivePositions(Summary, LimitLivePositionsKeys):
    pass

class LimitUnlikelyKeys:
    key: str
    value: float | None
    unit: str
    likely: str | None

class LimitUnlikely(Summary, LimitUnlikelyKeys):
    pass

class MapKeys:
    program: str
    version: str
    scenario: dict[str, Any]
    warnings: list[str]
    unlikely: list[MapUnlikely]
    record_checksums: list[str]
    one_direction: str | None
    cases: int
    friction_demand: float | None
    friction_condition: str | None
    failures: list[MapFailures]
    uncertain_cases: list[MapFailures]
    outside_model: int | None
    four_link_histories: int
    largest_thrust_excess_ratio: float | None
    histories: int
    histories_without_verdict: int
    longest_step_s: MapLongestStepS | None
    shortest_step_s: MapLongestStepS | None
    outcomes: str
    mirrored: int
    for_looking: str | None
    other_outcomes_in_repetitions: int | None

class Map(Summary, MapKeys):
    pass

class MapResult:
    @property
    def summary(self) -> Map: ...
    program: str
    version: str
    scenario: dict[str, Any]
    warnings: list[str]
    unlikely: list[MapUnlikely]
    record_checksums: list[str]
    one_direction: str | None
    cases: int
    friction_demand: float | None
    friction_condition: str | None
    failures: list[MapFailures]
    uncertain_cases: list[MapFailures]
    outside_model: int | None
    four_link_histories: int
    largest_thrust_excess_ratio: float | None
    histories: int
    histories_without_verdict: int
    longest_step_s: MapLongestStepS | None
    shortest_step_s: MapLongestStepS | None
    outcomes: str
    mirrored: int
    for_looking: str | None
    other_outcomes_in_repetitions: int | None

class MapUnlikelyKeys:
    key: str
    value: float | None
    unit: str
    likely: str | None

class MapUnlikely(Summary, MapUnlikelyKeys):
    pass

class MapFailuresKeys:
    case: str
    reason: str
    overturns_in: int
    of: int
    path_repeats: bool
    incomplete: list[str]
    failed: list[str]

class MapFailures(Summary, MapFailuresKeys):
    pass

class MapLongestStepSKeys:
    min: float
    max: float

class MapLongestStepS(Summary, MapLongestStepSKeys):
    pass

class PeaksKeys:
    models: list[PeaksModels]
    pairs: list[PeaksPairs]

class Peaks(Summary, PeaksKeys):
    pass

class PeaksResult:
    @property
    def summary(self) -> Peaks: ...
    models: list[PeaksModels]
    pairs: list[PeaksPairs]

class PeaksModelsKeys:
    model: str
    cases: int
    overturned: int
    peak_rotation_16_rad: float | None
    peak_rotation_50_rad: float | None
    peak_rotation_84_rad: float | None

class PeaksModels(Summary, PeaksModelsKeys):
    pass

class PeaksPairsKeys:
    models: list[str]
    kolmogorov_distance: float
    at_rotation_rad: float
    shares_there: list[float]

class PeaksPairs(Summary, PeaksPairsKeys):
    pass

class RecordKeys:
    file: str
    format: str
    sampling: str
    channel: int | None
    channel_name: str | None
    quantity: str
    unit: str
    samples: int
    dt_s: float | None
    duration_s: float
    gravity_m_s2: float
    peak_acceleration_m_s2: float
    peak_acceleration_time_s: float
    mean_acceleration_g: float
    mean_removed: bool
    baseline: str | None
    high_pass_hz: float | None
    corrections: str
    peak_velocity_m_s: float
    peak_velocity_time_s: float
    peak_displacement_m: float
    peak_displacement_time_s: float
    arias_intensity_m_s: float
    significant_from_s: float
    significant_to_s: float

class Record(Summary, RecordKeys):
    pass

class RecordResult:
    @property
    def summary(self) -> Record: ...
    file: str
    format: str
    sampling: str
    channel: int | None
    channel_name: str | None
    quantity: str
    unit: str
    samples: int
    dt_s: float | None
    duration_s: float
    gravity_m_s2: float
    peak_acceleration_m_s2: float
    peak_acceleration_time_s: float
    mean_acceleration_g: float
    mean_removed: bool
    baseline: str | None
    high_pass_hz: float | None
    corrections: str
    peak_velocity_m_s: float
    peak_velocity_time_s: float
    peak_displacement_m: float
    peak_displacement_time_s: float
    arias_intensity_m_s: float
    significant_from_s: float
    significant_to_s: float

class RunKeys:
    program: str
    version: str
    model: str
    scenario: dict[str, Any]
    record_checksums: list[str]
    verdict: str
    warnings: list[str]
    unlikely: list[RunUnlikely]
    outcome: str
    outcome_time_s: float
    overturning_sway: str | None
    mirrored: RunMirrored | None
    end_s: float
    impacts: int | None
    first_impact: RunFirstImpact | None
    hardest_impact: RunFirstImpact | None
    largest_peak_rotation_rad: float
    incipient_acceleration_g: BySide[float | None]
    wall_behind: str | None
    ground: RunGround
    energy_defect_ratio: float
    largest_friction_demand: float
    largest_friction_demand_time_s: float
    lasting_friction_demand: float | None
    friction_demand: float | None
    steps: int
    peak_rotation_over_critical: float | None
    thrust_excess_ratio: float | None
    remaining_energy_over_barrier: float | None
    dimensionless: RunDimensionless | None
    largest_thrust_excess_ratio: float
    largest_thrust_excess_time_s: float
    rocking_share_thrust_excess_below_0_01: float | None
    rocking_share_thrust_excess_below_0_05: float | None
    four_links: str | None
    is_continuous: bool
    evaluations: int
    half_cycles: list[RunHalfCycles]
    largest_compressive_stress_pa: float
    largest_compressive_stress_joint: int
    largest_compressive_stress_time_s: float
    elastic_j: float
    damping_time_s: float
    damped_j: float
    friction_j: float
    crushed_j: float
    ties_j: float
    rest_eccentricity_ratio: float
    rest_eccentricity_joint: int
    opening_tolerance_m: float
    vibrates_since_s: float | None
    slips_m: list[float]
    largest_slips_m: list[float]
    unconverged_steps: int
    friction_bound_error: float
    peak_potential_over_barrier: float | None
    ties: list[RunTies]
    largest_kinetic_j: float
    largest_potential_j: float
    energy_taken_j: float
    ground_j: float
    right_foot_j: float
    energy_defect_over_largest: float
    least_normal_n: float
    closure_error_m: float
    longest_step_s: float
    shortest_step_s: float
    programs: int
    most_iterations: int
    relaxed: int
    merged: int
    step_halvings: int
    start_s: float
    feet_farthest_apart_m: list[float]
    feet_farthest_apart_time_s: float
    feet_apart_at_end_m: list[float]
    records_end_s: list[float] | None
    friction_coefficient: float | None
    compressive_strength_mpa: float | None
    slipped_joints: list[int]
    iterations: int
    repeatability: RunRepeatability | None
    variations: list[RunVariations]
    points: list[RunPoints]
    to_quote: str | None
    compared_models: list[str]
    ignores_elastic_joints: bool
    uncertain: dict[str, Any] | None
    longest_step_us: float | None

class Run(Summary, RunKeys):
    pass

class RunResult:
    @property
    def summary(self) -> Run: ...
    program: str
    version: str
    model: str
    record_checksums: list[str]
    warnings: list[str]
    unlikely: list[RunUnlikely]
    outcome: str
    outcome_time_s: float
    overturning_sway: str | None
    end_s: float
    first_impact: RunFirstImpact | None
    hardest_impact: RunFirstImpact | None
    largest_peak_rotation_rad: float
    incipient_acceleration_g: BySide[float | None]
    wall_behind: str | None
    ground: RunGround
    energy_defect_ratio: float
    largest_friction_demand: float
    largest_friction_demand_time_s: float
    lasting_friction_demand: float | None
    steps: int
    peak_rotation_over_critical: float | None
    remaining_energy_over_barrier: float | None
    dimensionless: RunDimensionless | None
    largest_thrust_excess_ratio: float
    largest_thrust_excess_time_s: float
    rocking_share_thrust_excess_below_0_01: float | None
    rocking_share_thrust_excess_below_0_05: float | None
    four_links: str | None
    is_continuous: bool
    evaluations: int
    half_cycles: list[RunHalfCycles]
    largest_compressive_stress_pa: float
    largest_compressive_stress_joint: int
    largest_compressive_stress_time_s: float
    elastic_j: float
    damping_time_s: float
    damped_j: float
    friction_j: float
    crushed_j: float
    ties_j: float
    rest_eccentricity_ratio: float
    rest_eccentricity_joint: int
    opening_tolerance_m: float
    vibrates_since_s: float | None
    slips_m: list[float]
    largest_slips_m: list[float]
    unconverged_steps: int
    friction_bound_error: float
    peak_potential_over_barrier: float | None
    ties: list[RunTies]
    largest_kinetic_j: float
    largest_potential_j: float
    energy_taken_j: float
    ground_j: float
    right_foot_j: float
    energy_defect_over_largest: float
    least_normal_n: float
    closure_error_m: float
    longest_step_s: float
    shortest_step_s: float
    programs: int
    most_iterations: int
    relaxed: int
    merged: int
    step_halvings: int
    start_s: float
    feet_farthest_apart_m: list[float]
    feet_farthest_apart_time_s: float
    feet_apart_at_end_m: list[float]
    records_end_s: list[float] | None
    friction_coefficient: float | None
    compressive_strength_mpa: float | None
    slipped_joints: list[int]
    iterations: int
    points: list[RunPoints]
    compared_models: list[str]
    ignores_elastic_joints: bool
    uncertain: dict[str, Any] | None
    longest_step_us: float | None

class RunUnlikelyKeys:
    key: str
    value: float | None
    unit: str
    likely: str | None

class RunUnlikely(Summary, RunUnlikelyKeys):
    pass

class RunMirroredKeys:
    verdict: str
    outcome: str
    outcome_time_s: float
    overturning_sway: str | None
    largest_peak_rotation_rad: float | None
    peak_rotation_over_critical: float | None
    peak_potential_over_barrier: float | None
    thrust_excess_ratio: float | None
    friction_demand: float | None
    certainty: RunMirroredCertainty | None
    failed: str | None

class RunMirrored(Summary, RunMirroredKeys):
    pass

class RunMirroredCertaintyKeys:
    overturns_in: int
    of: int
    path_repeats: bool
    incomplete: list[str]
    failed: list[str]

class RunMirroredCertainty(Summary, RunMirroredCertaintyKeys):
    pass

class RunFirstImpactKeys:
    time_s: float
    restitution: float
    closed_joints: list[int]
    opened_joints: list[int]

class RunFirstImpact(Summary, RunFirstImpactKeys):
    pass

class RunGroundKeys:
    end_s: float
    peak_g: float
    whole_peak_g: float
    vertical_peak_g: float
    pushes_g: BySide[float]

class RunGround(Summary, RunGroundKeys):
    pass

class RunDimensionlessKeys:
    p_rad_s: float
    p_t_p: float | None
    peak_acceleration_over_incipient: float

class RunDimensionless(Summary, RunDimensionlessKeys):
    pass

class RunHalfCyclesKeys:
    sway: str
    start_s: float
    duration_s: float
    peak_rad: float
    peak_time_s: float
    energy_ratio: float | None

class RunHalfCycles(Summary, RunHalfCyclesKeys):
    pass

class RunTiesKeys:
    peak_force_n: float
    peak_force_time_s: float
    yielded_s: float | None
    broken_s: float | None
    yielded_m: float
    force_n: float
    elastic_j: float
    taken_j: float

class RunTies(Summary, RunTiesKeys):
    pass

class RunRepeatabilityKeys:
    outcomes: dict[Any, str]
    overturning_sways: dict[Any, str | None]
    overturns_in: int
    of: int
    path_repeats: bool
    incomplete: list[str]
    failed: list[str]
    half_cycles: list[RunRepeatabilityHalfCycles]
    same_until_half_cycle: int
    parts_at_s: float | None
    largest_rotation_rad: RunRepeatabilityHalfCyclesPeakRad | None
    slips_m: list[RunRepeatabilityHalfCyclesPeakRad]
    largest_slip_m: RunRepeatabilityHalfCyclesPeakRad | None
    friction_j: RunRepeatabilityHalfCyclesPeakRad | None

class RunRepeatability(Summary, RunRepeatabilityKeys):
    pass

class RunRepeatabilityHalfCyclesKeys:
    peak_time_s: float
    peak_rad: RunRepeatabilityHalfCyclesPeakRad | None

class RunRepeatabilityHalfCycles(Summary, RunRepeatabilityHalfCyclesKeys):
    pass

class RunRepeatabilityHalfCyclesPeakRadKeys:
    own: float
    min: float
    max: float

class RunRepeatabilityHalfCyclesPeakRad(Summary, RunRepeatabilityHalfCyclesPeakRadKeys):
    pass

class RunVariationsKeys:
    outcome: str
    outcome_time_s: float
    overturning_sway: str | None
    first_peak_rad: float | None
    largest_peak_rotation_rad: float
    failed: str
    mirrored: RunVariationsMirrored | None

class RunVariations(Summary, RunVariationsKeys):
    pass

class RunVariationsMirroredKeys:
    outcome: str
    outcome_time_s: float
    overturning_sway: str | None
    first_peak_rad: float | None
    largest_peak_rotation_rad: float
    failed: str

class RunVariationsMirrored(Summary, RunVariationsMirroredKeys):
    pass

class RunPointsKeys:
    x_m: float
    y_m: float
    peak_x_m: float
    peak_x_time_s: float
    peak_y_m: float
    peak_y_time_s: float

class RunPoints(Summary, RunPointsKeys):
    pass

class SpreadKeys:
    clear_span_m: float
    weight_n: float
    support: str
    friction_coefficient: float | None
    paths: list[SpreadPaths]
    warnings: list[str]
    unlikely: list[SpreadUnlikely]
    scenario: dict[str, Any]

class Spread(Summary, SpreadKeys):
    pass

class SpreadResult:
    @property
    def summary(self) -> Spread: ...
    clear_span_m: float
    weight_n: float
    support: str
    friction_coefficient: float | None
    paths: list[SpreadPaths]
    warnings: list[str]
    unlikely: list[SpreadUnlikely]
    scenario: dict[str, Any]

class SpreadPathsKeys:
    springing: str
    angle_deg: float
    falls_at_m: float | None
    falls_at_part_of_clear_span: float | None
    falls_by: list[SpreadPathsFallsBy]
    lost: str | None
    snaps: list[SpreadPathsSnaps]
    stages: list[SpreadPathsStages]

class SpreadPaths(Summary, SpreadPathsKeys):
    pass

class SpreadPathsFallsByKeys:
    joint: int
    edge: str

class SpreadPathsFallsBy(Summary, SpreadPathsFallsByKeys):
    pass

class SpreadPathsSnapsKeys:
    at_m: float
    hinges_before: list[SpreadPathsFallsBy] | None
    hinges_after: list[SpreadPathsFallsBy] | None
    by: list[SpreadPathsFallsBy]

class SpreadPathsSnaps(Summary, SpreadPathsSnapsKeys):
    pass

class SpreadPathsStagesKeys:
    movement_m: float
    hinges: list[SpreadPathsStagesHinges]
    thrust_n: float | None
    thrust_ratio: float | None
    right_support_force_n: list[float] | None
    friction_demand: float | None
    crown_drop_m: float
    first_motion_g: BySide[float | None]
    capacity_g: BySide[float | None]
    not_found: list[SpreadPathsStagesNotFound]

class SpreadPathsStages(Summary, SpreadPathsStagesKeys):
    pass

class SpreadPathsStagesHingesKeys:
    joint: int
    edge: str
    rotation_rad: float

class SpreadPathsStagesHinges(Summary, SpreadPathsStagesHingesKeys):
    pass

class SpreadPathsStagesNotFoundKeys:
    push: str
    side: str
    reason: str

class SpreadPathsStagesNotFound(Summary, SpreadPathsStagesNotFoundKeys):
    pass

class SpreadUnlikelyKeys:
    key: str
    value: float | None
    unit: str
    likely: str | None

class SpreadUnlikely(Summary, SpreadUnlikelyKeys):
    pass

class SuiteKeys:
    program: str
    version: str
    scenario: dict[str, Any]
    warnings: list[str]
    unlikely: list[SuiteUnlikely]
    to_quote: str | None
    friction_demand: float | None
    outcomes: str
    intensity: str
    median: float | None
    median_standard_error: float | None
    median_standard_error_by_record: float | None
    median_interval: list[float] | None
    extrapolated_beyond: float | None
    dispersion: float | None
    dispersion_standard_error: float | None
    dispersion_standard_error_by_record: float | None
    dispersion_interval: list[float] | None
    log_likelihood: float | None
    no_fit: str | None
    records: int
    as_recorded: SuiteAsRecorded | None
    cases: int
    overturned: int
    uncertain: int
    still_rocking_counted_as_not_overturned: int
    incomplete_left_out: int
    failed_left_out: int
    levels: SuiteLevels
    survivals: list[SuiteSurvivals]
    spectral: SuiteSpectral
    capacities: int
    capacities_at_most: int
    intensity_measures: list[SuiteIntensityMeasures]
    mirrored_cases_count: bool
    records_that_never_overturn: list[str]
    records_that_always_overturn: list[str]
    with_uncertain_as_survived: SuiteWithUncertainAsSurvived | None
    with_uncertain_as_overturned: SuiteWithUncertainAsSurvived | None
    failures: list[SuiteFailures]
    uncertain_cases: list[SuiteFailures]
    outside_model: int | None
    four_link_histories: int
    largest_thrust_excess_ratio: float | None
    histories: int
    histories_without_verdict: int
    longest_step_s: SuiteLongestStepS | None
    shortest_step_s: SuiteLongestStepS | None

class Suite(Summary, SuiteKeys):
    pass

class SuiteResult:
    @property
    def summary(self) -> Suite: ...
    program: str
    version: str
    scenario: dict[str, Any]
    warnings: list[str]
    unlikely: list[SuiteUnlikely]
    to_quote: str | None
    friction_demand: float | None
    outcomes: str
    intensity: str
    median: float | None
    median_standard_error: float | None
    median_standard_error_by_record: float | None
    median_interval: list[float] | None
    extrapolated_beyond: float | None
    dispersion: float | None
    dispersion_standard_error: float | None
    dispersion_standard_error_by_record: float | None
    dispersion_interval: list[float] | None
    log_likelihood: float | None
    no_fit: str | None
    records: int
    as_recorded: SuiteAsRecorded | None
    cases: int
    overturned: int
    still_rocking_counted_as_not_overturned: int
    incomplete_left_out: int
    failed_left_out: int
    levels: SuiteLevels
    survivals: list[SuiteSurvivals]
    spectral: SuiteSpectral
    capacities: int
    capacities_at_most: int
    intensity_measures: list[SuiteIntensityMeasures]
    mirrored_cases_count: bool
    records_that_never_overturn: list[str]
    records_that_always_overturn: list[str]
    with_uncertain_as_survived: SuiteWithUncertainAsSurvived | None
    with_uncertain_as_overturned: SuiteWithUncertainAsSurvived | None
    failures: list[SuiteFailures]
    uncertain_cases: list[SuiteFailures]
    outside_model: int | None
    four_link_histories: int
    largest_thrust_excess_ratio: float | None
    histories: int
    histories_without_verdict: int
    longest_step_s: SuiteLongestStepS | None
    shortest_step_s: SuiteLongestStepS | None

class SuiteUnlikelyKeys:
    key: str
    value: float | None
    unit: str
    likely: str | None

class SuiteUnlikely(Summary, SuiteUnlikelyKeys):
    pass

class SuiteAsRecordedKeys:
    records_that_overturn: int
    share: float
    records_in_doubt: int

class SuiteAsRecorded(Summary, SuiteAsRecordedKeys):
    pass

class SuiteLevelsKeys:
    count: int
    to: float

class SuiteLevels(Summary, SuiteLevelsKeys):
    pass

class SuiteSurvivalsKeys:
    record: str
    survives_up_to: float | None
    overturns_from: float | None
    at_most: bool
    ranges: list[SuiteSurvivalsRanges]
    levels_only: bool

class SuiteSurvivals(Summary, SuiteSurvivalsKeys):
    pass

class SuiteSurvivalsRangesKeys:
    verdict: str | None
    to: float

class SuiteSurvivalsRanges(Summary, SuiteSurvivalsRangesKeys):
    pass

class SuiteSpectralKeys:
    period_s: float
    damping_percent: float

class SuiteSpectral(Summary, SuiteSpectralKeys):
    pass

class SuiteIntensityMeasuresKeys:
    measure: str
    capacities: int
    median: float
    dispersion: float
    dispersion_of_factor: float
    dispersion_of_factor_interval: list[float] | None
    best_share: float

class SuiteIntensityMeasures(Summary, SuiteIntensityMeasuresKeys):
    pass

class SuiteWithUncertainAsSurvivedKeys:
    median: float | None
    median_standard_error: float | None
    median_standard_error_by_record: float | None
    median_interval: list[float] | None
    extrapolated_beyond: float | None
    dispersion: float | None
    dispersion_standard_error: float | None
    dispersion_standard_error_by_record: float | None
    dispersion_interval: list[float] | None
    log_likelihood: float | None
    no_fit: str | None

class SuiteWithUncertainAsSurvived(Summary, SuiteWithUncertainAsSurvivedKeys):
    pass

class SuiteFailuresKeys:
    case: str
    reason: str
    overturns_in: int
    of: int
    path_repeats: bool
    incomplete: list[str]
    failed: list[str]

class SuiteFailures(Summary, SuiteFailuresKeys):
    pass

class SuiteLongestStepSKeys:
    min: float
    max: float

class SuiteLongestStepS(Summary, SuiteLongestStepSKeys):
    pass

class ThresholdAlongKeys:
    program: str
    version: str
    scenario: dict[str, Any]
    warnings: list[str]
    unlikely: list[ThresholdAlongUnlikely]
    record_checksums: list[str]
    one_direction: str | None
    cases: int
    friction_demand: float | None
    friction_condition: str | None
    failures: list[ThresholdAlongFailures]
    uncertain_cases: list[ThresholdAlongFailures]
    outside_model: int | None
    four_link_histories: int
    largest_thrust_excess_ratio: float | None
    histories: int
    histories_without_verdict: int
    longest_step_s: ThresholdAlongLongestStepS | None
    shortest_step_s: ThresholdAlongLongestStepS | None
    to_quote: str | None
    values_without_verdict: int
    along: ThresholdAlongAlong
    factors: ThresholdAlongFactors
    no_impact: bool

class ThresholdAlong(Summary, ThresholdAlongKeys):
    pass

class ThresholdAlongResult:
    @property
    def summary(self) -> ThresholdAlong: ...
    program: str
    version: str
    scenario: dict[str, Any]
    warnings: list[str]
    unlikely: list[ThresholdAlongUnlikely]
    record_checksums: list[str]
    one_direction: str | None
    cases: int
    friction_demand: float | None
    friction_condition: str | None
    failures: list[ThresholdAlongFailures]
    uncertain_cases: list[ThresholdAlongFailures]
    outside_model: int | None
    four_link_histories: int
    largest_thrust_excess_ratio: float | None
    histories: int
    histories_without_verdict: int
    longest_step_s: ThresholdAlongLongestStepS | None
    shortest_step_s: ThresholdAlongLongestStepS | None
    to_quote: str | None
    values_without_verdict: int
    along: ThresholdAlongAlong
    factors: ThresholdAlongFactors
    no_impact: bool

class ThresholdAlongUnlikelyKeys:
    key: str
    value: float | None
    unit: str
    likely: str | None

class ThresholdAlongUnlikely(Summary, ThresholdAlongUnlikelyKeys):
    pass

class ThresholdAlongFailuresKeys:
    case: str
    reason: str
    overturns_in: int
    of: int
    path_repeats: bool
    incomplete: list[str]
    failed: list[str]

class ThresholdAlongFailures(Summary, ThresholdAlongFailuresKeys):
    pass

class ThresholdAlongLongestStepSKeys:
    min: float
    max: float

class ThresholdAlongLongestStepS(Summary, ThresholdAlongLongestStepSKeys):
    pass

class ThresholdAlongAlongKeys:
    key: str
    to: float
    count: int

class ThresholdAlongAlong(Summary, ThresholdAlongAlongKeys):
    pass

class ThresholdAlongFactorsKeys:
    to: float | None
    stride: float

class ThresholdAlongFactors(Summary, ThresholdAlongFactorsKeys):
    pass

class ThresholdAlongValuesKeys:
    value: float
    survives_up_to_factor: float | None
    survives_up_to_g: float | None
    overturns_from_factor: float | None
    overturns_from_g: float | None
    at_most: bool
    uncertain_from_factor: float | None
    tried_to_factor: float | None
    failed_beyond: bool
    no_impact_factor: float | None
    no_impact_g: float | None
    thrust_excess_ratio: float | None
    friction_demand: float | None
    direction: str | None
    why_not: str | None

class ThresholdAlongValues(Summary, ThresholdAlongValuesKeys):
    pass

class ThresholdKeys:
    program: str
    version: str
    record: str | None
    peak_acceleration_g: float
    factors: ThresholdFactors
    free_fall_factor: float | None
    warnings: list[str]
    unlikely: list[ThresholdUnlikely]
    to_quote: str | None
    models: list[ThresholdModels]

class Threshold(Summary, ThresholdKeys):
    pass

class ThresholdResult:
    @property
    def summary(self) -> Threshold: ...
    program: str
    version: str
    record: str | None
    peak_acceleration_g: float
    factors: ThresholdFactors
    free_fall_factor: float | None
    warnings: list[str]
    unlikely: list[ThresholdUnlikely]
    to_quote: str | None
    models: list[ThresholdModels]

class ThresholdFactorsKeys:
    to: float | None
    stride: float

class ThresholdFactors(Summary, ThresholdFactorsKeys):
    pass

class ThresholdUnlikelyKeys:
    key: str
    value: float | None
    unit: str
    likely: str | None

class ThresholdUnlikely(Summary, ThresholdUnlikelyKeys):
    pass

class ThresholdModelsKeys:
    model: str
    scenario: dict[str, Any]
    record_checksums: list[str]
    searched_factors: ThresholdModelsSearchedFactors
    survives_up_to_factor: float | None
    lowest_factor: float | None
    friction_demand: float | None
    direction: str
    ranges: list[ThresholdModelsRanges]
    bands: list[ThresholdModelsBands]
    gaps: list[ThresholdModelsBands]
    uncertain: list[ThresholdModelsBands]
    incomplete: list[ThresholdModelsBands]
    samples: list[ThresholdModelsSamples]
    mirrored: ThresholdModelsMirrored | None
    failures: list[ThresholdModelsFailures]
    uncertain_cases: list[ThresholdModelsFailures]
    outside_model: int | None
    four_link_histories: int
    largest_thrust_excess_ratio: float | None
    histories: int
    histories_without_verdict: int
    longest_step_s: ThresholdModelsLongestStepS | None
    shortest_step_s: ThresholdModelsLongestStepS | None
    variations: list[ThresholdModelsVariations]

class ThresholdModels(Summary, ThresholdModelsKeys):
    pass

class ThresholdModelsSearchedFactorsKeys:
    to: float
    stride: float
    begins_at_onset: bool
    lower_not_tried: bool
    ends_at_collapse: bool

class ThresholdModelsSearchedFactors(Summary, ThresholdModelsSearchedFactorsKeys):
    pass

class ThresholdModelsRangesKeys:
    verdict: str | None
    to: float

class ThresholdModelsRanges(Summary, ThresholdModelsRangesKeys):
    pass

class ThresholdModelsBandsKeys:
    to: float
    from_end: str
    to_end: str
    from_peak_g: float
    to_peak_g: float

class ThresholdModelsBands(Summary, ThresholdModelsBandsKeys):
    pass

class ThresholdModelsSamplesKeys:
    factor: float
    outcome: str
    overturning_sway: str | None
    impacts: int | None
    outcome_time_s: float
    peak_rotation_over_critical: float | None
    peak_rotation_rad: float | None
    thrust_excess_ratio: float | None
    friction_demand: float | None
    overturns_in: int
    of: int
    path_repeats: bool
    incomplete: list[str]
    failed: list[str]
    reason: str | None

class ThresholdModelsSamples(Summary, ThresholdModelsSamplesKeys):
    pass

class ThresholdModelsMirroredKeys:
    ranges: list[ThresholdModelsRanges]
    bands: list[ThresholdModelsBands]
    gaps: list[ThresholdModelsBands]
    uncertain: list[ThresholdModelsBands]
    incomplete: list[ThresholdModelsBands]
    samples: list[ThresholdModelsSamples]

class ThresholdModelsMirrored(Summary, ThresholdModelsMirroredKeys):
    pass

class ThresholdModelsFailuresKeys:
    case: str
    reason: str
    overturns_in: int
    of: int
    path_repeats: bool
    incomplete: list[str]
    failed: list[str]

class ThresholdModelsFailures(Summary, ThresholdModelsFailuresKeys):
    pass

class ThresholdModelsLongestStepSKeys:
    min: float
    max: float

class ThresholdModelsLongestStepS(Summary, ThresholdModelsLongestStepSKeys):
    pass

class ThresholdModelsVariationsKeys:
    factor: float | None
    from_end: str | None
    peak_g: float | None
    incomplete: int
    survives_up_to_factor: float | None
    is_repeated: bool
    failed: str | None

class ThresholdModelsVariations(Summary, ThresholdModelsVariationsKeys):
    pass

class VerifyKeys:
    program: str
    version: str
    title: str | None
    formulas: str | None
    scenario_sha256: str
    files: list[VerifyFiles]
    zeta_e: float | None
    no_zeta_e_because: str | None
    verdict: dict[Any, str]
    confidence_factor: float
    behaviour_factor: float
    sides: str
    wall_behind: str | None
    t0_s: float | None
    gravity_m_s2: float
    allowed_friction: float
    mechanisms: dict[Any, VerifyMechanisms]
    states: dict[Any, VerifyStates]
    warnings: list[str]
    unlikely: list[VerifyUnlikely]
    decisions: list[VerifyDecisions]
    assumptions: list[str]
    not_covered: list[str]
    scenario: dict[str, Any]
    tie_places: list[str]
    is_symmetric: bool
    top: str
    geometry: VerifyGeometry
    free_standing: VerifyFreeStanding | None
    language: str

class Verify(Summary, VerifyKeys):
    pass

class VerifyResult:
    @property
    def summary(self) -> Verify: ...
    program: str
    version: str
    title: str | None
    formulas: str | None
    scenario_sha256: str
    zeta_e: float | None
    no_zeta_e_because: str | None
    verdict: dict[Any, str]
    confidence_factor: float
    behaviour_factor: float
    sides: str
    wall_behind: str | None
    t0_s: float | None
    gravity_m_s2: float
    allowed_friction: float
    mechanisms: dict[Any, VerifyMechanisms]
    states: dict[Any, VerifyStates]
    warnings: list[str]
    unlikely: list[VerifyUnlikely]
    decisions: list[VerifyDecisions]
    assumptions: list[str]
    not_covered: list[str]
    scenario: dict[str, Any]
    tie_places: list[str]
    is_symmetric: bool
    top: str
    geometry: VerifyGeometry
    free_standing: VerifyFreeStanding | None
    language: str

class VerifyFilesKeys:
    file: str
    sha256: str

class VerifyFiles(Summary, VerifyFilesKeys):
    pass

class VerifyMechanismsKeys:
    hinges: list[VerifyMechanismsHinges]
    bodies: list[VerifyMechanismsBodies]
    ties: list[VerifyMechanismsTies]
    forces: list[VerifyMechanismsForces]
    sum_f_delta_l_kn: float
    sum_p_kn: float
    sum_p_delta_x_kn: float
    sum_p_delta_x2_kn: float
    sum_p_delta_y_kn: float
    alpha0: float
    moving_mass_kg: float
    e_star: float
    m_star_kg: float
    a0_over_fc_g: float
    a0_with_separate_loads_over_fc_g: float | None
    d_c0_m: float | None
    d0_m: float | None
    d_c0_crown_m: float | None
    d0_crown_m: float | None
    d_y_m: float | None
    a_y_over_fc_g: float | None
    friction: float | None
    curve_m_g: list[list[float]] | None
    positions: list[VerifyMechanismsPositions]
    no_curve: Any | None
    sliding: VerifyMechanismsSliding | None
    top_reaction_kn: float | None

class VerifyMechanisms(Summary, VerifyMechanismsKeys):
    pass

class VerifyMechanismsHingesKeys:
    angle_deg: float
    edge: str | None
    joint: int
    height_m: float
    side: str
    x_m: float
    y_m: float

class VerifyMechanismsHinges(Summary, VerifyMechanismsHingesKeys):
    pass

class VerifyMechanismsBodiesKeys:
    mass_kg: float
    weight_kn: float
    x_m: float
    y_m: float
    delta_x: float
    delta_y: float
    rotation_per_m: float
    blocks: list[int] | None

class VerifyMechanismsBodies(Summary, VerifyMechanismsBodiesKeys):
    pass

class VerifyMechanismsTiesKeys:
    force_kn: float
    delta_l: float
    ends_m: list[list[float]]
    blocks: list[int | None]

class VerifyMechanismsTies(Summary, VerifyMechanismsTiesKeys):
    pass

class VerifyMechanismsForcesKeys:
    x_m: float
    y_m: float
    force_x_kn: float
    force_y_kn: float
    delta_x: float
    delta_y: float

class VerifyMechanismsForces(Summary, VerifyMechanismsForcesKeys):
    pass

class VerifyMechanismsPositionsKeys:
    part_of_d0: float
    displacement_m: float
    acceleration_g: float
    hinges_m: list[list[float]]
    centres_m: list[list[float]]

class VerifyMechanismsPositions(Summary, VerifyMechanismsPositionsKeys):
    pass

class VerifyMechanismsSlidingKeys:
    coefficient: float
    bound_g: float

class VerifyMechanismsSliding(Summary, VerifyMechanismsSlidingKeys):
    pass

class VerifyStatesKeys:
    right: VerifyStatesRight
    left: VerifyStatesRight
    verdict: str
    zeta_e: float | None
    side: str | None
    method: str | None
    demand: VerifyStatesDemand
    rule: VerifyStatesRule | None
    histories: VerifyStatesHistories | None

class VerifyStates(Summary, VerifyStatesKeys):
    pass

class VerifyStatesDemandKeys:
    soil: str
    ag_g: float
    f0: float
    tc_star_s: float
    s_s: float
    s_t: float
    s: float
    c_c: float
    t_b_s: float
    t_c_s: float
    t_d_s: float
    t_e_s: float
    peak_g: float
    peak_displacement_m: float
    modes: list[VerifyStatesDemandModes]
    a_z_g: float
    spectrum: str
    damping_percent: float
    points_s_g: list[list[float]]

class VerifyStatesDemand(Summary, VerifyStatesDemandKeys):
    pass

class VerifyStatesDemandModesKeys:
    t_s: float
    damping_percent: float
    gamma: float
    psi: float
    acceleration_g: float
    a_z_g: float
    f: float

class VerifyStatesDemandModes(Summary, VerifyStatesDemandModesKeys):
    pass

class VerifyStatesRuleKeys:
    part_of_d0: float
    period_factor: float
    damping_percent: float
    divide_acceleration: float
    divide_displacement: float

class VerifyStatesRule(Summary, VerifyStatesRuleKeys):
    pass

class VerifyStatesHistoriesKeys:
    right: VerifyStatesHistoriesRight
    left: VerifyStatesHistoriesRight
    demand: str
    passed: bool | None
    passed_over_fc: bool | None
    incomplete: int
    outside_model: int | None
    four_link_histories: int
    largest_thrust_excess_ratio: float | None
    records: list[VerifyStatesHistoriesRecords]
    mean_spectrum: VerifyStatesHistoriesMeanSpectrum

class VerifyStatesHistories(Summary, VerifyStatesHistoriesKeys):
    pass

class VerifyStatesHistoriesRecordsKeys:
    right: VerifyStatesHistoriesRecordsRight
    left: VerifyStatesHistoriesRecordsRight
    file: str
    crc32: str
    peak_g: float
    thrust_excess_ratio: float | None

class VerifyStatesHistoriesRecords(Summary, VerifyStatesHistoriesRecordsKeys):
    pass

class VerifyStatesHistoriesRecordsRightKeys:
    peak_m: float | None
    overturned: bool
    incomplete: bool

class VerifyStatesHistoriesRecordsRight(Summary, VerifyStatesHistoriesRecordsRightKeys):
    pass

class VerifyStatesHistoriesMeanSpectrumKeys:
    from_s: float
    to_s: float
    least_ratio: float | None
    largest_ratio: float | None
    fits: bool | None

class VerifyStatesHistoriesMeanSpectrum(Summary, VerifyStatesHistoriesMeanSpectrumKeys):
    pass

class VerifyStatesHistoriesRightKeys:
    restitution: float | None
    demand_m: float | None
    mean_interval_m: list[float] | None
    capacity_m: float
    capacity_over_fc_m: float
    d0_m: float
    records_beyond_d0: int
    records_beyond_d0_over_fc: int
    records_outside_model: int
    passed: bool | None
    passed_over_fc: bool | None
    overturned: bool

class VerifyStatesHistoriesRight(Summary, VerifyStatesHistoriesRightKeys):
    pass

class VerifyStatesRightKeys:
    zeta_e: float | None
    sliding: VerifyStatesRightSliding | None
    activation: VerifyStatesRightActivation | None
    simplified: VerifyStatesRightSimplified | None
    displacement: VerifyStatesRightDisplacement | None
    floor: list[VerifyStatesRightFloor]

class VerifyStatesRight(Summary, VerifyStatesRightKeys):
    pass

class VerifyStatesRightSlidingKeys:
    bound_g: float
    demand_g: float
    verdict: str

class VerifyStatesRightSliding(Summary, VerifyStatesRightSlidingKeys):
    pass

class VerifyStatesRightActivationKeys:
    capacity_g: float
    demand_g: float
    ag_capacity_g: float | None
    ag_g: float | None
    zeta_e: float
    passed: bool

class VerifyStatesRightActivation(Summary, VerifyStatesRightActivationKeys):
    pass

class VerifyStatesRightSimplifiedKeys:
    activation_ag_g: float
    q: float
    ag_capacity_g: float | None
    ag_g: float | None
    zeta_e: float
    passed: bool

class VerifyStatesRightSimplified(Summary, VerifyStatesRightSimplifiedKeys):
    pass

class VerifyStatesRightDisplacementKeys:
    reached_m: float
    capacity_m: float
    acceleration_g: float
    period_s: float
    demand_m: float
    demand_period_s: float | None
    resonance_m: float | None
    demand_acceleration_g: float
    by_displacement_ag_g: float | None
    activation_governs: bool
    ag_capacity_following_g: float | None
    zeta_e_crown: float | None
    acceleration_crown_g: float | None
    period_crown_s: float | None
    ag_capacity_g: float | None
    ag_g: float | None
    zeta_e: float
    passed: bool
    activation_ag_g: float | None

class VerifyStatesRightDisplacement(Summary, VerifyStatesRightDisplacementKeys):
    pass

class VerifyStatesRightFloorKeys:
    period_s: float
    modes_g: list[float]
    ground_g: float
    acceleration_g: float

class VerifyStatesRightFloor(Summary, VerifyStatesRightFloorKeys):
    pass

class VerifyUnlikelyKeys:
    key: str
    value: float | None
    unit: str
    likely: str | None

class VerifyUnlikely(Summary, VerifyUnlikelyKeys):
    pass

class VerifyDecisionsKeys:
    name: str
    text: str

class VerifyDecisions(Summary, VerifyDecisionsKeys):
    pass

class VerifyGeometryKeys:
    shape: str
    depth_m: float
    density_kg_m3: float
    ring: VerifyGeometryRing | None
    blocks: list[VerifyGeometryBlocks]
    fill: VerifyGeometryFill | None
    loads: list[VerifyGeometryLoads]

class VerifyGeometry(Summary, VerifyGeometryKeys):
    pass

class VerifyGeometryRingKeys:
    mean_radius_m: float
    thickness_m: float
    embrace_deg: float
    voussoirs: int | None

class VerifyGeometryRing(Summary, VerifyGeometryRingKeys):
    pass

class VerifyGeometryBlocksKeys:
    corners_m: list[list[float]]
    density_kg_m3: float
    masonry_kg: float
    fill_kg: float
    loads_kg: float
    centre_m: list[float]

class VerifyGeometryBlocks(Summary, VerifyGeometryBlocksKeys):
    pass

class VerifyGeometryFillKeys:
    height_m: float
    is_above_crown: bool
    density_kg_m3: float

class VerifyGeometryFill(Summary, VerifyGeometryFillKeys):
    pass

class VerifyGeometryLoadsKeys:
    block: int
    at_m: list[float]
    width_m: float
    mass_kg: float
    moves: bool
    thrust_kn: float

class VerifyGeometryLoads(Summary, VerifyGeometryLoadsKeys):
    pass

class VerifyFreeStandingKeys:
    t0_s: float
    kappa: float
    length_m: float
    thickness_m: float
    modulus_gpa: float

class VerifyFreeStanding(Summary, VerifyFreeStandingKeys):
    pass

class EventKeys:
    time_s: float
    kind: str
    state: str
    mechanism: int | None
    rotations_rad: list[float]
    rates_rad_s: list[float]
    energy_j: float
    hinges: list[EventHinges]
    impact: EventImpact | None
    tie: int | None

class Event(Summary, EventKeys):
    pass

class EventResult:
    @property
    def summary(self) -> Event: ...
    time_s: float
    kind: str
    state: str
    mechanism: int | None
    rotations_rad: list[float]
    rates_rad_s: list[float]
    energy_j: float
    hinges: list[EventHinges]
    impact: EventImpact | None
    tie: int | None

class EventHingesKeys:
    angle_deg: float
    edge: str | None
    joint: int
    height_m: float
    side: str

class EventHinges(Summary, EventHingesKeys):
    pass

class EventImpactKeys:
    sway_before: str
    strikes_wall: bool
    restitution: float
    energy_before_j: float
    energy_after_j: float
    friction_j: float | None
    rates_before_rad_s: list[float]
    rates_after_rad_s: list[float]
    closed: list[EventHinges]
    opened: list[EventHinges]
    impulses_n_s: list[list[float]]

class EventImpact(Summary, EventImpactKeys):
    pass
