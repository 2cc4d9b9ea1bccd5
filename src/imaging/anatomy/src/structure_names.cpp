// SPDX-License-Identifier: Apache-2.0
// Sources of the names: Terminologia Anatomica (FIPAT); the class maps that label_schemes.cpp cites; 3D Slicer's GenericAnatomyColors.
#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "trocar/anatomy/structure.h"

namespace trocar::anatomy {
namespace {

struct Names {
  Structure structure;
  const char* names;  ///< separated by "|", lower case, without accents
};

constexpr Names kTable[] = {
    {Structure::kLiver,
     "liver|hepar|iecur|jecur|hepatic parenchyma|liver "
     "parenchyma|leber|foie|higado|fegato|figado|lever|печень|肝|肝脏|肝臟|肝臓|간|간장"},
    {Structure::kLiverPart,
     "liver left|liver right|liver left lobe|liver right lobe|left hepatic lobe|right hepatic lobe|left lobe "
     "liver|right lobe liver|"
     "caudate lobe|liver caudate lobe|quadrate lobe|lobus hepatis dexter|lobus hepatis sinister|lobus "
     "caudatus|linker leberlappen|"
     "rechter leberlappen|liver segment 1|liver segment 2|liver segment 3|liver segment 4|liver segment "
     "4a|liver segment 4b|"
     "liver segment 5|liver segment 6|liver segment 7|liver segment 8|liver segment i|liver segment ii|liver "
     "segment iii|"
     "liver segment iv|liver segment iva|liver segment ivb|liver segment v|liver segment vi|liver segment "
     "vii|liver segment viii"},
    {Structure::kLiverLesion,
     "liver tumor|liver tumour|liver tumors|liver tumours|hepatic tumor|hepatic tumour|liver lesion|liver "
     "lesions|hepatic lesion|"
     "liver cyst|liver cysts|hepatic cyst|liver metastasis|liver metastases|liver "
     "cancer|hcc|lebertumor|leberlasion|leberzyste|"
     "tumeur du foie|tumeur hepatique|lesion hepatique|tumor de higado|tumor hepatico|lesion hepatica|tumore "
     "del fegato|"
     "tumore epatico|tumor do figado|levertumor|肝肿瘤|肝腫瘍"},
    {Structure::kLiverVessel,
     "liver vessel|liver vessels|hepatic vessel|hepatic vessels|hepatic vein|hepatic veins|venae "
     "hepaticae|vena hepatica|"
     "right hepatic vein|middle hepatic vein|left hepatic vein|lebervene|lebervenen|lebergefasse|veine "
     "hepatique|veines hepatiques|"
     "vena hepatica|venas hepaticas|vene epatiche|veias hepaticas|levervene|levervenen|肝静脉|肝静脈"},
    {Structure::kGallbladder,
     "gallbladder|gall bladder|gallblader|gb|vesica biliaris|vesica fellea|cholecystis|gallenblase|vesicule "
     "biliaire|vesicule|"
     "vesicula biliar|vesicula|colecisti|cistifellea|vescica biliare|vescichetta biliare|galblaas|желчный "
     "пузырь|胆囊|膽囊|胆のう|胆嚢|"
     "담낭|쓸개"},
    {Structure::kGallbladderPart,
     "gallstone|gallstones|gallbladder stone|gallbladder stones|gallbladder wall|gallbladder "
     "lumen|gallenstein|gallensteine|"
     "calcul biliaire|calculs biliaires|calculo biliar|calculos biliares|calcoli "
     "biliari|galstenen|胆结石|胆石"},
    {Structure::kBileDuct,
     "bile duct|bile ducts|biliary tree|biliary duct|biliary ducts|common bile duct|cbd|common hepatic "
     "duct|cystic duct|"
     "ductus choledochus|ductus cysticus|ductus hepaticus "
     "communis|gallengang|gallengange|gallenwege|choledoque|canal choledoque|"
     "voies biliaires|canal cystique|coledoco|conducto cistico|conducto biliar|conductos biliares|via "
     "biliar|via biliare|vie biliari|"
     "dotto cistico|dotto coledoco|ducto cistico|vias biliares|galweg|galwegen|galgang|胆管|膽管|胆总管"},
    {Structure::kArtery,
     "arteries|artery|hepatic artery|hepatic arteries|proper hepatic artery|common hepatic artery|hepatic "
     "artery proper|"
     "right hepatic artery|left hepatic artery|cystic artery|arteria hepatica|arteria hepatica "
     "propria|arteria cystica|leberarterie|"
     "artere hepatique|arteria epatica|肝动脉|肝動脈"},
    {Structure::kSpleen, "spleen|splen|lien|milz|rate|bazo|milza|baco|milt|селезенка|脾|脾脏|脾臟|脾臓|비장"},
    {Structure::kStomach, "stomach|gaster|ventriculus|magen|estomac|estomago|stomaco|maag|желудок|胃|위"},
    {Structure::kDuodenum,
     "duodenum|zwolffingerdarm|duodeno|twaalfvingerige darm|двенадцатиперстная "
     "кишка|十二指肠|十二指腸|십이지장"},
    {Structure::kColon,
     "colon|large bowel|large intestine|intestinum crassum|dickdarm|kolon|gros intestin|intestino "
     "grueso|intestino grosso|dikke darm|"
     "ascending colon|transverse colon|descending colon|sigmoid colon|толстая "
     "кишка|结肠|大肠|結腸|大腸|대장|결장"},
    {Structure::kSmallBowel,
     "small bowel|small intestine|intestine|intestinum tenue|jejunum|ileum|dunndarm|intestin grele|intestino "
     "delgado|intestino tenue|"
     "dunne darm|тонкая кишка|小肠|小腸|소장"},
    {Structure::kPancreas,
     "pancreas|bauchspeicheldruse|pankreas|alvleesklier|поджелудочная железа|胰|胰腺|胰脏|胰臟|膵|膵臓|췌장"},
    {Structure::kKidneyRight,
     "right kidney|kidney right|ren dexter|rechte niere|niere rechts|rein droit|rinon derecho|rene "
     "destro|rim direito|rechter nier|"
     "rechternier|правая почка|右肾|右腎|右肾脏|右腎臟|右腎臓|오른쪽 신장|우측 신장"},
    {Structure::kKidneyLeft,
     "left kidney|kidney left|ren sinister|linke niere|niere links|rein gauche|rinon izquierdo|rene "
     "sinistro|rim esquerdo|linker nier|"
     "linkernier|левая почка|左肾|左腎|左肾脏|左腎臟|左腎臓|왼쪽 신장|좌측 신장"},
    {Structure::kKidneys,
     "kidney|kidneys|ren|renes|niere|nieren|rein|reins|rinon|rinones|rene|reni|rim|rins|nier|почка|почки|肾|"
     "腎|肾脏|腎臟|腎臓|신장|콩팥"},
    {Structure::kAdrenalRight,
     "right adrenal|right adrenal gland|right suprarenal gland|rag|glandula suprarenalis dextra|rechte "
     "nebenniere|surrenale droite|"
     "glandula suprarrenal derecha|surrene destro|右肾上腺|右副腎"},
    {Structure::kAdrenalLeft,
     "left adrenal|left adrenal gland|left suprarenal gland|lag|glandula suprarenalis sinistra|linke "
     "nebenniere|surrenale gauche|"
     "glandula suprarrenal izquierda|surrene sinistro|左肾上腺|左副腎"},
    {Structure::kAdrenals,
     "adrenal|adrenals|adrenal gland|adrenal glands|suprarenal gland|glandula "
     "suprarenalis|nebenniere|nebennieren|surrenale|surrenales|"
     "glandula suprarrenal|surrene|surreni|bijnier|bijnieren|肾上腺|副腎"},
    {Structure::kVenaCava,
     "inferior vena cava|ivc|postcava|vena cava|vena cava inferior|untere hohlvene|veine cave "
     "inferieure|veine cave|vci|"
     "vena cava inferiore|veia cava inferior|onderste holle ader|нижняя полая "
     "вена|下腔静脉|下腔靜脈|下大静脈|하대정맥"},
    {Structure::kAorta,
     "aorta|arota|abdominal aorta|aorta abdominalis|bauchaorta|aorte|aorte "
     "abdominale|аорта|主动脉|主動脈|大动脉|大動脈|腹主动脉|대동맥"},
    {Structure::kPortalVein,
     "portal vein|portal vein and splenic vein|portal and splenic veins|portal splenic vein|portal vein "
     "splenic vein|pv|"
     "portal vein and superior mesenteric vein|vena portae|vena portae hepatis|pfortader|veine porte|vena "
     "porta|veia porta|poortader|"
     "воротная вена|门静脉|門靜脈|門脈|문맥"},
    {Structure::kEsophagus,
     "esophagus|oesophagus|speiserohre|osophagus|oesophage|esofago|slokdarm|пищевод|食管|食道|식도"},
    {Structure::kLungRight,
     "right lung|pulmo dexter|rechte lunge|poumon droit|pulmon derecho|polmone destro|pulmao direito|right "
     "lung upper lobe|"
     "right lung middle lobe|right lung lower lobe|right upper lobe|right lower lobe|middle lobe|superior "
     "lobe of right lung|"
     "middle lobe of right lung|inferior lobe of right lung|правое легкое|右肺"},
    {Structure::kLungLeft,
     "left lung|pulmo sinister|linke lunge|poumon gauche|pulmon izquierdo|polmone sinistro|pulmao "
     "esquerdo|left lung upper lobe|"
     "left lung lower lobe|left upper lobe|left lower lobe|superior lobe of left lung|inferior lobe of left "
     "lung|левое легкое|左肺"},
    {Structure::kLungs,
     "lung|lungs|pulmo|pulmones|lunge|lungen|poumon|poumons|pulmon|polmone|polmoni|pulmao|pulmoes|long|"
     "longen|легкое|легкие|肺|肺脏|폐"},
    {Structure::kHeart,
     "heart|cor|herz|coeur|corazon|cuore|coracao|hart|heart myocardium|right atrium|left atrium|right "
     "ventricle|left ventricle|"
     "heart atrium right|heart atrium left|heart ventricle right|heart ventricle left|right ventricle of "
     "heart|left ventricle of heart|"
     "сердце|心脏|心臟|心臓|심장"},
    {Structure::kChest,
     "trachea|bronchi|bronchus|pulmonary vein|pulmonary artery|superior vena "
     "cava|sternum|mediastinum|pericardium|thymus|airway|airways|"
     "atrial appendage left|brachiocephalic trunk|brachiocephalic vein left|brachiocephalic vein "
     "right|subclavian artery left|"
     "subclavian artery right|scapula left|scapula right|clavicula left|clavicula right|clavicle "
     "left|clavicle right|humerus left|"
     "humerus right|lung vessels|lung tumor|lung nodule|pleura|breast"},
    {Structure::kHead,
     "brain|head|neck|skull|face|mandible|thyroid gland|thyroid|common carotid artery left|common carotid "
     "artery right"},
    {Structure::kBladder,
     "urinary bladder|bladder|vesica urinaria|harnblase|vessie|vejiga|vejiga urinaria|vescica|vescica "
     "urinaria|bexiga|blaas|urineblaas|"
     "мочевой пузырь|膀胱|방광"},
    {Structure::kPelvis,
     "prostate|uterus|prostate uterus|prostate or uterus|rectum|ovary|seminal vesicle|femur left|femur "
     "right|hip left|hip right|"
     "head of femur left|head of femur right|head femur left|head femur right|gluteus maximus left|gluteus "
     "maximus right|"
     "gluteus medius left|gluteus medius right|gluteus minimus left|gluteus minimus right|iliac artery "
     "left|iliac artery right|"
     "iliac vena left|iliac vena right|iliac vein left|iliac vein right|pelvis"},
    {Structure::kRibs,
     "rib|ribs|costa|costae|rippe|rippen|cote|cotes|costilla|costillas|costola|costole|costela|costelas|"
     "ribben|ребро|ребра|肋骨|늑골"},
    {Structure::kVertebra,
     "spine|vertebra|vertebrae|vertebral column|columna vertebralis|lumbar vertebral column|thoracic "
     "vertebral column|wirbel|"
     "wirbelsaule|vertebre|vertebres|rachis|colonne vertebrale|columna vertebral|colonna vertebrale|coluna "
     "vertebral|wervelkolom|"
     "wervel|vertebra l1|vertebra l2|vertebra l5|vertebra t7|vertebra t8|vertebra t9|vertebra t10|vertebra "
     "t11|vertebra t12|l1|l2|l5|t7|"
     "t8|t9|t10|t11|t12|позвоночник|脊柱|脊椎|椎骨|척추"},
    {Structure::kUpperVertebra,
     "cervical vertebral column|vertebra c1|vertebra c2|vertebra c3|vertebra c4|vertebra c5|vertebra "
     "c6|vertebra c7|vertebra t1|"
     "vertebra t2|vertebra t3|vertebra t4|vertebra t5|vertebra t6|c1|c2|c3|c4|c5|c6|c7|t1|t2|t3|t4|t5|t6"},
    {Structure::kVertebraL3, "vertebra l3|l3"},
    {Structure::kVertebraL4, "vertebra l4|l4"},
    {Structure::kSacrum, "sacrum|os sacrum|kreuzbein|sacro|vertebra s1|s1|крестец|骶骨|仙骨"},
    {Structure::kBody, "body|skin|trunk|body trunc|body trunk|korper|haut|corps|cuerpo|corpo|lichaam"},
    // of no account, named so that a file of such names is not taken for one in an unknown language
    {Structure::kOther,
     "tissue|bone|bones|muscle|muscles|fat|subcutaneous fat|torso fat|skeletal muscle|intermuscular "
     "fat|spinal cord|"
     "kidney cyst left|kidney cyst right|kidney tumor|kidney tumour|kidney mass|kidney lesion|pancreas "
     "tumor|pancreatic tumor|"
     "pancreas lesion|colon tumor|colon cancer|colon cancer primaries|tumor|tumour|lesion|celiac "
     "trunk|celiac artery|"
     "superior mesenteric artery|superior mesenteric vein|splenic vein|splenic artery|autochthon "
     "left|autochthon right|iliopsoas left|"
     "iliopsoas right|psoas left|psoas right|costal cartilages|costal cartilage|intervertebral "
     "discs|connective tissue|blood|organ|mass|"
     "foreign object|waste|teeth|ligament|tendon|cartilage|nerve|vein|lymph "
     "node|peritoneum|omentum|abdomen|thorax|abdominal cavity|"
     "unknown|stent|calcification"}};

/// Words that say nothing of what a segment is.
constexpr std::string_view kIdleWords[] = {
    "mask",   "seg",   "segmentation", "label",     "labels", "whole", "entire", "total", "full",
    "organ",  "the",   "of",           "structure", "roi",    "auto",  "manual", "gt",    "pred",
    "ground", "truth", "prediction",   "predicted", "nii",    "gz",    "nrrd",   "mha",   "ct",
    "mr",     "mri",   "predictions",  "volume",    "all",    "copy",  "final",  "edited"};

constexpr std::pair<std::string_view, std::string_view> kSameWords[] = {
    {"r", "right"},
    {"rt", "right"},
    {"l", "left"},
    {"lt", "left"},
    {"re", "rechts"},
    {"li", "links"},
    {"tumours", "tumors"},
    {"vertebrae", "vertebra"},
    {"segments", "segment"},
    {"zwoelffingerdarm", "zwolffingerdarm"},
    {"speiseroehre", "speiserohre"}};

/// Code points; bytes that are no UTF-8 are Latin-1.
std::vector<char32_t> Decode(std::string_view text) {
  std::vector<char32_t> points;
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const int more = byte >= 0xf0 ? 3 : byte >= 0xe0 ? 2 : byte >= 0xc2 ? 1 : 0;
    bool is_whole = byte < 0xf5 && i + static_cast<std::size_t>(more) < text.size();
    char32_t point = more == 0 ? byte : byte & (0x3f >> more);
    for (int k = 1; is_whole && k <= more; ++k) {
      const auto next = static_cast<unsigned char>(text[i + static_cast<std::size_t>(k)]);
      is_whole = (next & 0xc0) == 0x80;
      point = point << 6 | (next & 0x3f);
    }
    points.push_back(is_whole ? point : byte);
    i += is_whole ? static_cast<std::size_t>(more) + 1 : 1;
  }
  return points;
}

void Encode(char32_t point, std::string& text) {
  if (point < 0x80) {
    text += static_cast<char>(point);
  } else if (point < 0x800) {
    text += static_cast<char>(0xc0 | point >> 6);
    text += static_cast<char>(0x80 | (point & 0x3f));
  } else if (point < 0x10000) {
    text += static_cast<char>(0xe0 | point >> 12);
    text += static_cast<char>(0x80 | (point >> 6 & 0x3f));
    text += static_cast<char>(0x80 | (point & 0x3f));
  } else {
    text += static_cast<char>(0xf0 | point >> 18);
    text += static_cast<char>(0x80 | (point >> 12 & 0x3f));
    text += static_cast<char>(0x80 | (point >> 6 & 0x3f));
    text += static_cast<char>(0x80 | (point & 0x3f));
  }
}

/// A letter in lower case without its accent; nothing for what is no letter or digit.
void AppendFolded(char32_t point, std::string& word) {
  if (point < 0x80) {
    const char c = static_cast<char>(point);
    if (c >= 'A' && c <= 'Z') {
      word += static_cast<char>(c + 'a' - 'A');
    } else if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) {
      word += c;
    }
    return;
  }
  // U+00C0 to U+00FF in order, "." where the sign is no letter
  constexpr std::string_view kLatin1 = "aaaaaaaceeeeiiiidnooooo.ouuuuytsaaaaaaaceeeeiiiidnooooo.ouuuuyty";
  if (point >= 0xc0 && point <= 0xff) {
    word += kLatin1[point - 0xc0];
  } else if (point == 0x152 || point == 0x153) {
    word += "oe";
  } else if (point == 0x419 || point == 0x439) {
    Encode(0x438, word);  // its breve may come as an accent of its own
  } else if (point >= 0x410 && point <= 0x42f) {
    Encode(point + 0x20, word);
  } else if (point == 0x401 || point == 0x451) {
    Encode(0x435, word);
  } else if (point >= 0x300 && point <= 0x36f) {
    // an accent of its own
  } else {
    Encode(point, word);
  }
}

bool IsBreak(char32_t point) {
  if (point >= 0x80)
    return point == 0xa0 || point == 0xb7 || (point >= 0x2000 && point <= 0x206f) || point == 0x3000;
  const char c = static_cast<char>(point);
  return !((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '\'');
}

std::vector<std::string> WordsOf(std::string_view text) {
  std::vector<std::string> words(1);
  for (const char32_t point : Decode(text)) {
    if (!IsBreak(point)) {
      AppendFolded(point, words.back());
    } else if (!words.back().empty()) {
      words.emplace_back();
    }
  }
  if (words.back().empty()) words.pop_back();
  for (std::string& word : words) {
    for (const auto& [from, to] : kSameWords) {
      if (word == from) word = to;
    }
  }
  return words;
}

std::string Join(const std::vector<std::string>& words, const char* between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

/// The words in the order of the alphabet: "kidney right".
std::string SortedWords(std::vector<std::string> words) {
  std::sort(words.begin(), words.end());
  return Join(words, " ");
}

/// By the words in any order, and by all words as one.
class Dictionary {
 public:
  Dictionary() {
    for (const Names& entry : kTable) {
      const std::string_view names = entry.names;
      for (std::size_t begin = 0; begin <= names.size();) {
        const std::size_t end = std::min(names.find('|', begin), names.size());
        const auto words = WordsOf(names.substr(begin, end - begin));
        by_words_.emplace(SortedWords(words), entry.structure);
        joined_.emplace(Join(words, ""), entry.structure);
        joined_.emplace(Join({words.rbegin(), words.rend()}, ""), entry.structure);
        begin = end + 1;
      }
    }
  }
  std::optional<Structure> Find(const std::vector<std::string>& words) const {
    if (const auto found = by_words_.find(SortedWords(words)); found != by_words_.end()) return found->second;
    if (const auto found = joined_.find(Join(words, "")); found != joined_.end()) return found->second;
    return std::nullopt;
  }

 private:
  std::map<std::string, Structure> by_words_, joined_;
};

bool Has(const std::vector<std::string>& words, std::initializer_list<std::string_view> wanted) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    return std::find(wanted.begin(), wanted.end(), word) != wanted.end();
  });
}

/// Ribs and vertebrae come with numbers and sides.
Structure FindNumbered(const std::vector<std::string>& words) {
  if (words.empty() || Has(words, {"cartilage", "cartilages", "fracture", "lesion"}))
    return Structure::kUnknown;
  const auto starts = [&](std::string_view with) {
    return std::any_of(words.begin(), words.end(),
                       [&](const std::string& word) { return word.starts_with(with); });
  };
  if (Has(words, {"rib", "ribs", "rippe", "costilla", "costola", "costela"}) ||
      words.front().starts_with("rib")) {
    const bool is_right =
        Has(words, {"right", "rechts", "derecha", "destra"}) || words.front().starts_with("ribright");
    const bool is_left =
        Has(words, {"left", "links", "izquierda", "sinistra"}) || words.front().starts_with("ribleft");
    return is_right && !is_left   ? Structure::kRibsRight
           : is_left && !is_right ? Structure::kRibsLeft
                                  : Structure::kRibs;
  }
  return starts("vertebra") ? Structure::kVertebra : Structure::kUnknown;
}

}  // namespace

const char* NameOf(Structure structure) noexcept {
  constexpr std::array<const char*, static_cast<std::size_t>(Structure::kCount)> kNames = {
      "unknown",
      "other",
      "liver",
      "part_of_liver",
      "liver_lesion",
      "liver_vessels",
      "gallbladder",
      "part_of_gallbladder",
      "bile_ducts",
      "arteries",
      "spleen",
      "stomach",
      "duodenum",
      "colon",
      "small_bowel",
      "pancreas",
      "kidney_right",
      "kidney_left",
      "kidneys",
      "adrenal_right",
      "adrenal_left",
      "adrenals",
      "inferior_vena_cava",
      "aorta",
      "portal_vein",
      "esophagus",
      "lung_right",
      "lung_left",
      "lungs",
      "heart",
      "organ_of_chest",
      "head_or_neck",
      "urinary_bladder",
      "organ_of_pelvis",
      "ribs_right",
      "ribs_left",
      "ribs",
      "upper_vertebra",
      "vertebra",
      "vertebra_L3",
      "vertebra_L4",
      "sacrum",
      "body"};
  return kNames[static_cast<std::size_t>(structure)];
}

Structure FindStructure(std::string_view name) {
  static const Dictionary dictionary;
  std::vector<std::string> words = WordsOf(name);
  if (const auto found = dictionary.Find(words)) return *found;
  std::erase_if(words, [](const std::string& word) {
    return std::find(std::begin(kIdleWords), std::end(kIdleWords), word) != std::end(kIdleWords);
  });
  if (words.empty()) return Structure::kUnknown;
  if (const auto found = dictionary.Find(words)) return *found;
  return FindNumbered(words);
}

bool IsPlaceholder(std::string_view name) {
  constexpr std::string_view kMadeUp[] = {"segment", "label", "region", "object", "class",  "value",
                                          "roi",     "mask",  "new",    "seg",    "unnamed"};
  const auto words = WordsOf(name);
  return std::all_of(words.begin(), words.end(), [&](std::string word) {
    while (!word.empty() && word.back() >= '0' && word.back() <= '9') word.pop_back();
    return word.empty() || std::find(std::begin(kMadeUp), std::end(kMadeUp), word) != std::end(kMadeUp);
  });
}

roles::NeighbourRole RoleOf(Structure structure) noexcept {
  using roles::NeighbourRole;
  switch (structure) {
    case Structure::kStomach:
      return NeighbourRole::kStomach;
    case Structure::kDuodenum:
      return NeighbourRole::kDuodenum;
    case Structure::kColon:
      return NeighbourRole::kColon;
    case Structure::kSmallBowel:
      return NeighbourRole::kSmallBowel;
    case Structure::kPancreas:
      return NeighbourRole::kPancreas;
    case Structure::kKidneyRight:
      return NeighbourRole::kRightKidney;
    case Structure::kVenaCava:
      return NeighbourRole::kVenaCava;
    case Structure::kAorta:
      return NeighbourRole::kAorta;
    case Structure::kPortalVein:
      return NeighbourRole::kPortalVein;
    case Structure::kRibs:
    case Structure::kRibsLeft:
    case Structure::kRibsRight:
      return NeighbourRole::kRibs;
    case Structure::kUpperVertebra:
    case Structure::kVertebra:
    case Structure::kVertebraL3:
    case Structure::kVertebraL4:
    case Structure::kSacrum:
      return NeighbourRole::kSpine;
    default:
      return NeighbourRole::kOther;
  }
}

}  // namespace trocar::anatomy
